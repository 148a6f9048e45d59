"""Order in which values pass through components whose outputs depend on inputs at the same instant."""

from orchestration.system.system import System


def chain_of_feedthrough(system: System, shortest: int) -> list[int]:
    """Return the components in an order in which each one comes after those that it depends on at the same instant.

    Parameters
    ----------
    shortest
        Fewest components that must depend on each other in a row.

    Returns
    -------
    list of int
        Places of the components in the system. Empty if no chain is that long, or if components depend on each
        other in a circle.
    """
    place = {component.name: i for i, component in enumerate(system.components)}
    followers: list[set[int]] = [set() for _ in place]
    for connection in system.connections:
        if system.component(connection.source).variable(connection.output).direct:
            followers[place[connection.source]].add(place[connection.target])
    waits_for = [0] * len(place)
    for targets in followers:
        for target in targets:
            waits_for[target] += 1
    order, depth = [i for i, n in enumerate(waits_for) if n == 0], [1] * len(place)
    for i in order:  # grows while it is read
        for target in followers[i]:
            depth[target] = max(depth[target], depth[i] + 1)
            waits_for[target] -= 1
            if waits_for[target] == 0:
                order.append(target)
    return order if len(order) == len(place) and max(depth) >= shortest else []
