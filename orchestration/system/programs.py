"""What a system can become besides a run: one program, in several forms."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.system.registry import program_writer

if TYPE_CHECKING:
    from orchestration.master.algorithm import Algorithm


class Programs:
    """Methods of a system that write it as one program, which needs neither a master nor Python."""

    def to_c(self, folder: str | Path, algorithm: "str | Algorithm" = "gauss-seidel") -> Path:
        """Write the system as a folder of C11 that needs no library: ``step.h``, an example and a Makefile.

        The step, the order of the components and the start values of the system become a part of the program. Its
        values are those of `simulate`, to the last bit.

        Parameters
        ----------
        folder
            Folder that does not exist, is empty, or has an earlier program, which is replaced.
        algorithm
            ``gauss-seidel`` or ``jacobi``.

        Raises
        ------
        ContainerError
            If an FMU does not bring the sources that a program needs, outputs depend on each other in a cycle during
            initialization, the algorithm is another one, or the folder has other files.
        SystemDescriptionError
            If the system has no step, or a sampling period is not a multiple of it.

        Examples
        --------
        >>> from orchestration import scenario
        >>> folder = scenario("fig2").to_c("fig2_in_c")
        >>> sorted(file.name for file in folder.iterdir())
        ['Makefile', 'README.md', 'failure.h', 'fmus', 'hash.h', 'main.c', 'step.c', 'step.h']
        """
        return program_writer("c")(self, folder, algorithm=algorithm)

    def to_fmu(
        self,
        path: str | Path,
        *,
        platforms: Iterable[str] | None = None,
        algorithm: "str | Algorithm" = "gauss-seidel",
    ) -> Path:
        """Write the system as one FMU for co-simulation, FMI 2.0, which any tool runs and which holds its sources.

        Parameters, unconnected inputs and outputs are called ``component.variable``. The communication step is any
        whole multiple of the system's step. Values are those of `simulate`, to the last bit.

        Parameters
        ----------
        path
            File to write, ``NAME.fmu``.
        platforms
            Names of the platforms with a binary in the FMU, see `adaptimp_fmu.PLATFORMS`, or ``"all"`` among them.
            Default: this machine's.
        algorithm
            ``gauss-seidel`` or ``jacobi``.

        Raises
        ------
        ContainerError
            If the system cannot be one program, see `to_c`, a platform is unknown, or the compiler fails.
        SystemDescriptionError
            If the system has no step, or a sampling period is not a multiple of it.

        Examples
        --------
        >>> from orchestration import System, scenario, simulate
        >>> arm = scenario("fig2")
        >>> path = arm.to_fmu("arm.fmu")
        >>> one, many = simulate(System.of({"arm": path}), 0.1, 1e-3), simulate(arm, 0.1)
        >>> bool((one["arm.plant.x[1]"] == many["plant.x[1]"][::10]).all())
        True
        """
        return program_writer("fmu")(self, path, platforms=platforms, algorithm=algorithm)

    def to_wasm(self, path: str | Path, algorithm: "str | Algorithm" = "gauss-seidel") -> Path:
        """Write the system as a module of WebAssembly that imports nothing, for node and for pages.

        ``NAME.json`` and ``NAME.mjs`` are written beside the module ``NAME.wasm``. The first describes the variables
        of the module, and the second is the host in JavaScript. The three files are written together or not at all.
        The values of a run are those of `simulate`, to the last bit.

        Parameters
        ----------
        path
            File with the suffix ``.wasm``. The files of an earlier module are replaced.
        algorithm
            ``gauss-seidel`` or ``jacobi``.

        Raises
        ------
        ContainerError
            As of `to_c`; also if the sources of an FMU need an operating system, such as files or a clock.
        SystemDescriptionError
            As of `to_c`.

        Examples
        --------
        >>> from orchestration import scenario
        >>> module = scenario("fig2").to_wasm("fig2.wasm")
        >>> sorted(file.name for file in module.parent.glob("fig2.*"))
        ['fig2.json', 'fig2.mjs', 'fig2.wasm']
        """
        return program_writer("wasm")(self, path, algorithm=algorithm)
