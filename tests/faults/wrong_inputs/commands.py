"""Wrong command lines."""

from tests.faults.wrong_inputs.case import Wrong


def _run(options: str, where: str, values: str, repair: str) -> Wrong:
    """A run of the loop with wrong options."""
    return Wrong(f"run {options}", f"run {{package}} {options}", where, values, repair)


TABLE = (
    Wrong("run fgi5", "run fgi5", "scenario fgi5", "fig5", "did you mean"),
    Wrong("run Fig5", "run Fig5", "scenario Fig5", "fig5", "case-sensitive"),
    Wrong("run lop.ssp", "run lop.ssp", "lop.ssp", "no such package", "folder"),
    Wrong("run a file of results", "run result.csv", "result.csv", ".ssp", "adaptimp"),
    _run("--set controller.k=4000", "controller|variable k", "controller.K", "case-sensitive"),
    _run("--set controller.Ks=4000", "controller|Ks", "K", "did you mean"),
    _run("--set contoller.K=4000", "contoller", "controller", "did you mean"),
    _run("--set controller.K", "--set controller.K", "VALUE", "such as"),
    _run("--set controller.K=4000N/m", "controller.K", "in N/m", "plain number"),
    _run("--set controller.K=[1,2,3]", "controller.K", "3|2", "one for all"),
    _run("--set controller.K=[1,2", "controller.K", "[1,2", "]"),
    _run("--set controller.K=-5 --stop 1e-3", "controller|K[1] = -5", "1e-12 N/m", "must be at least"),
    _run("--set plant.K_f=-5 --stop 1e-3", "plant|K_f = -5", "0 N/m", "must be at least"),
    _run("--stop 0", "stop time 0 s", "start time 0 s", "later"),
    _run("--stop 1e9", "1e+13 steps", "GB", "larger step"),
    _run("--stop soon", "--stop", "", "should be a valid number"),
    _run("--step 1e-10", "steps", "GB", "larger step"),
    _run("--step 3e-4", "trajectory|sample time 0.0001 s", "0.0003 s", "use"),
    _run("--step 1e-4 --sample-time 1e-4", "--step", "--sample-time", "exclude each other"),
    _run("--record plant.xx", "plant|xx", "x", "did you mean"),
    _run("--record plnt.*", "no output fits 'plnt.*'", "plant.x", "did you mean"),
    _run("--every 0", "every", "0", "at least 1"),
    _run("--every 1.5", "--every", "", "should be a valid integer"),
    _run("--order plant,sensr", "order", "sensr|sensor", "did you mean"),
    _run("--algorithm jacoby", "algorithm 'jacoby'", "jacobi", "did you mean"),
    _run("--tolerance 1e-6", "gauss-seidel", "no tolerance", "adaptive"),
    _run("--algorithm adaptive --absolute mm=1e-3", "tolerance in mm", "units", "m"),
    _run("--algorithm adaptive --absolute m=small", "--absolute", "'small'", "number"),
    _run("--crossing plant.gop", "plant|gop", "gap", "did you mean"),
    _run("--ratio plnt=2", "plnt", "plant", "did you mean"),
    _run("--ratio plant=half", "--ratio", "'half'", "integer"),
    _run("--controller HoganImpedence", "HoganImpedence", "HoganImpedance", "did you mean"),
    _run("--controller {fmus}/Plant.fmu", "Plant|tau_cmd", "q, dq", "HoganImpedance"),
    _run("--controller {fmus}/Plnt.fmu", "Plnt.fmu", "Plant.fmu", "did you mean"),
    _run("--map tau_cmd=Torque", "--map", "--controller", "give one"),
    _run("--out a.xlsx", "a.xlsx", ".csv or .parquet", "written as"),
    _run("--fast", "--fast", "No such option", "Possible options"),
    Wrong("simulate", "simulate fig2", "No such command 'simulate'", "", "-h' for help"),
    Wrong("check plnt.fmu", "check {fmus}/Plnt.fmu", "Plnt.fmu", "Plant.fmu", "did you mean"),
    Wrong("check --role", "check {fmus}/Plant.fmu --role plnt", "role plnt", "plant", "did you mean"),
    Wrong("export fig9", "export fig9 --out a.ssp", "scenario fig9", "fig", "did you mean"),
    Wrong("export a.zip", "export fig2 --out a.zip", "a.zip", ".ssp", "end it with"),
    Wrong("build --platform linux", "build --platform linux", "platform linux", "linux64", "did you mean"),
    Wrong("build mine.fmu", "build mine.fmu", "mine.fmu", "Python file", "declare"),
    Wrong("paper --format pgn", "paper --format pgn", "format pgn", "png", "did you mean"),
)
