"""Where a master and the process of an isolated FMU put what they tell each other: words of a shared memory.

The memory begins with words of eight bytes, `Word`, and goes on with the arrays of the present call. The master writes
the arguments, then the number of the call. The other process makes the call, writes the results and the status, and
then the call `IDLE`. A process that has waited in vain for a while says that it sleeps, and is woken by a byte
in a socket.
"""

from enum import IntEnum

NO_RESULT = -(2**62)
"""What stands in place of a status until there is one; no status is so low."""

CALLS = (
    *("fmi2SetReal", "fmi2SetInteger", "fmi2SetBoolean", "fmi2GetReal", "fmi2GetInteger", "fmi2GetBoolean"),
    *("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2SetRealInputDerivatives", "fmi2GetDirectionalDerivative"),
    "fmi2DoStep",
)
"""Functions that compiled code hands over; the call of each is its place here, counted from 1."""
NUMBERS = {name: 1 + i for i, name in enumerate(CALLS)}

IDLE, SLOW, GONE = 0, len(CALLS) + 1, len(CALLS) + 2
"""What stands in place of a call: nothing to do; a message in the socket; the other process has ended."""

LOAD, UNLOAD = "load", "unload"
"""Requests beside the functions of FMI."""

LONGEST_SLEEP = 20  # ms, after which Python looks whether the other process lives
WORD = 8  # bytes


class Word(IntEnum):
    """Words at the beginning of the shared memory; those of each direction are 64 bytes apart, a processor's unit."""

    CALL = 0
    STATUS = 1
    N = 2
    M = 3
    TIME = 4
    STEP = 5
    FINAL = 6
    SERVER_SLEEPS = 8
    MASTER_SLEEPS = 9
    SAID = 10
    """Messages that the FMU has logged and that are still in the socket."""
    ARRAYS = 16
    """The arrays of the present call begin here."""


class Caller(IntEnum):
    """Words of the record that stands for the instance in the master's process."""

    SHARED = 0
    SPINS = 1
    YIELDS = 2
    YIELD = 3
    WRITE = 4
    BELL = 5
    BYTE = 6
    ENDED = 7
    """1 once the other process has ended: every further call returns fmi2Fatal at once."""
    CAPACITY = 8
    """Bytes of the arrays."""
    ATTEND = 9
    """Address of the function that waits on, in Python. It may break off, so it is called until there is a result."""
    READ = 10
    POLL = 11
    POLLED = 12
    """Address of the two records of ``poll``: of the socket that wakes, and of that for messages."""
    RESULT = 13
    """Status of the call, once ``ATTEND`` has waited for it."""
    LENGTH = 14


class Server(IntEnum):
    """Words of the record of the process that holds the FMU; the addresses of the FMU's functions come last."""

    SHARED = 0
    SPINS = 1
    YIELDS = 2
    YIELD = 3
    WRITE = 4
    BELL = 5
    BYTE = 6
    READ = 7
    COMPONENT = 8
    FUNCTIONS = 9


COMMON = (Caller.SPINS, Caller.YIELDS, Caller.YIELD, Caller.WRITE, Caller.BELL, Caller.BYTE)
"""Words in the same places of both: turns of waiting, addresses of ``sched_yield`` and ``write``, and for the byte that
wakes the other process the descriptor and an address."""


def arrays_size(n_variables: int) -> int:
    """Bytes that the arrays of a call may take, for an FMU with so many variables."""
    return 4096 + 4 * 32 * n_variables
