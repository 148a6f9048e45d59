"""The rules of a check: what each finding means, where FMI says so, and what to do about it.

`docs/check-rules.md` shows this table to users. Sections are those of FMI 2.0.4.
"""

from dataclasses import dataclass

from orchestration.check.findings import ROLE, Severity

ERROR, WARNING, NOTE = Severity.ERROR, Severity.WARNING, Severity.NOTE
LOOP = "loop"  # in the place of a rule's number: the closed loop of a role
PAGE = "docs/check-rules.md"


@dataclass(frozen=True)
class Rule:
    """A kind of finding.

    Attributes
    ----------
    id
        Number in the checklist, or a word.
    section
        Sections of FMI 2.0.4; empty for what FMI does not ask.
    fault
        What is wrong, as a sentence.
    remedy
        What the author of the FMU, or its user, does about it, as a sentence.
    """

    id: str
    severity: Severity
    section: str
    fault: str
    remedy: str


RULES = (
    Rule(
        *("1", ERROR, "2.2.1, 2.2"),
        "The description is missing, damaged, of another version of FMI, without CoSimulation, or without a GUID.",
        "Export the FMU again, for co-simulation of FMI 2.0.",
    ),
    Rule(
        *("2", ERROR, "2.2.7"),
        "Causality, variability and `initial` of a variable exclude each other, or time is two variables.",
        "Declare the combination that the message gives; an Integer, a Boolean and a String need a variability.",
    ),
    Rule(
        *("3", ERROR, "2.2.7"),
        "A start value is missing, is where none may be, or differs between aliases of one variable.",
        "Give a start value to inputs and to `exact` and `approx` variables, to one alias, and to no other variable.",
    ),
    Rule(
        *("3", WARNING, "2.2.7"),
        "An input has `initial`, or a variable has an attribute of model exchange such as `reinit`.",
        "Leave the attribute out.",
    ),
    Rule(
        *("4", ERROR, "2.2.8"),
        "An index in ModelStructure is not that of a variable, or dependencies and their kinds differ in number.",
        "Count variables from 1, and give a kind for each dependency or for none.",
    ),
    Rule(
        *("4", WARNING, "2.2.8"),
        "ModelStructure lacks a variable, lists one too many, is out of order, or is silent about dependencies.",
        "List all outputs and what initialization computes, in ascending order; declare dependencies, even none.",
    ),
    Rule(
        *("5", ERROR, "2.2.2, 2.2.3, 2.2.5, 2.2.7"),
        "A name occurs twice, a unit or type is undeclared, aliases differ in unit, or an experiment makes no sense.",
        "Declare what is used, once; give a stop time behind the start time, and a positive step.",
    ),
    Rule(
        *("5", WARNING, "2.2.2, 2.2.7, 2.2.9"),
        "A name breaks the structured grammar, a unit has no BaseUnit, or a start value is out of its limits.",
        "Quote odd names, give units their BaseUnit, and choose limits that hold the start value.",
    ),
    Rule(
        *("6", ERROR, "2.2.1, 2.3, 4.3.1"),
        "There is no binary for this machine, modelIdentifier is not a C identifier, or flags contradict each other.",
        "Build the FMU for this platform (`fmpy compile` does so from sources), and set the flags to what it can do.",
    ),
    Rule(
        *("6", WARNING, "2.2.4, 2.3"),
        "A platform's folder has no file named after the model, identifiers differ, or a log category occurs twice.",
        "Name each library after the modelIdentifier.",
    ),
    Rule(
        *("7", ERROR, "2.3"),
        "The archive is unsafe or damaged, has an entry twice, or lacks sources without which there is nothing to run.",
        "Pack the FMU again with a usual zip tool; do not use a file that leads outside of itself.",
    ),
    Rule(
        *("7", WARNING, "2.3"),
        "A declared source file, or a file that a source includes, is not in the archive.",
        "Add the file to `sources/`, or leave the sources out.",
    ),
    Rule(
        *("7", NOTE, "4.3.1"),
        "The FMU needs the tool that exported it.",
        "Install the tool where the FMU is to run, or export a stand-alone FMU.",
    ),
    Rule(
        *("8", ERROR, "2.1.2, 2.1.3"),
        "The library does not load, is for another processor, or does not export all 34 functions of co-simulation.",
        "Export every function; one that is not supported returns fmi2Error.",
    ),
    Rule(
        *("8", WARNING, "4.3.1"),
        "The library needs an interpreter of its host, and does not say so.",
        "Declare needsExecutionTool, or link the interpreter.",
    ),
    Rule(
        *("8", NOTE, "2.1.2"),
        "The library exports other names, needs uncommon libraries, or looks for them in odd places.",
        "Hide what is not FMI's, and link statically what another machine may lack.",
    ),
    Rule(
        *("9", ERROR, "2.1.5"),
        "fmi2Instantiate gives no instance, or dies.",
        "Read the message; if it names the GUID, description and binary are of different versions.",
    ),
    Rule(
        *("9", WARNING, "2.1.5"),
        "A wrong GUID is accepted, or the binary prints to standard output.",
        "Compare the GUID, and give texts to the logger.",
    ),
    Rule(
        *("10", ERROR, "2.1.4, 2.1.6, 2.1.7"),
        "fmi2Terminate, or a call before a mistake is tried, fails.",
        "Let every function work in every state in which FMI allows it.",
    ),
    Rule(
        *("10", WARNING, "2.1.4, 2.1.7"),
        "The version or platform is wrong, or a value reference that does not exist is accepted or crashes the FMU.",
        "Check references before they are used, and return fmi2Error.",
    ),
    Rule(
        *("11", ERROR, "2.1.6, 4.2.2"),
        "Initialization or a step fails, crashes, hangs, ends the process, or outputs are not finite.",
        "Run the FMU alone with its start values in a debugger; the message names the call.",
    ),
    Rule(
        *("11", WARNING, "4.2.2"),
        "A step of negative length or of NaN is accepted, crashes or hangs.",
        "Check the step and the communication point, and return fmi2Error.",
    ),
    Rule(
        *("11", NOTE, "2.2.5"),
        "The description proposes no step, and a usual one is refused.",
        "Give DefaultExperiment a stepSize that the FMU takes.",
    ),
    Rule(
        *("12", ERROR, "2.1.7, 4.2.4"),
        "A call fails that belongs to a value which must not be set.",
        "Let the call work in this state.",
    ),
    Rule(
        *("12", WARNING, "2.1.7, 4.2.4"),
        "An output or a fixed parameter can be set after initialization.",
        "Return fmi2Error, so that a wrong connection is noticed.",
    ),
    Rule(
        *("13", ERROR, "2.1.6, 2.1.8"),
        "After a reset, or from a saved or serialized state, the same calls give other bits.",
        "Keep all that decides outputs in the state: inputs, parameters, clocks, random numbers.",
    ),
    Rule(
        *("13", WARNING, "2.1.8"),
        "Two runs differ without a cause, or half a state is accepted.",
        "Seed random numbers, share no memory between instances, and store a length or checksum with the state.",
    ),
    Rule(
        *("13", NOTE, "2.1.8, 4.2.4"),
        "A serialized state can be set in an initialized instance only.",
        "Nothing must be done; masters that restore into a fresh instance cannot use the FMU.",
    ),
    Rule(
        *("14", ERROR, "4.3.1"),
        "Instances influence each other, or many of them one after the other crash.",
        "Keep memory in the instance, free it, or declare canBeInstantiatedOnlyOncePerProcess.",
    ),
    Rule(
        *("14", WARNING, "4.2.2, 4.3.1"),
        "A sampled FMU gives other values if a step is split in two.",
        "Tick by the number of sampling periods, not by the number of steps.",
    ),
    Rule(
        *("16", ERROR, "2.1.9"),
        "A directional derivative differs from the difference of outputs.",
        "Derive the equations again, or do not declare providesDirectionalDerivative.",
    ),
    Rule(
        *("17", ERROR, "2.1.5, 2.1.7"),
        "A call, or loading, changes the arithmetic of its host, or writes where the caller does not expect it.",
        "Link without -ffast-math, restore what is set, copy inputs before they are changed, fill what is asked for.",
    ),
    Rule(
        *("17", WARNING, ""),
        "A call, or loading, changes the locale, the working directory or the handlers of signals of its host.",
        "Restore them before the call returns.",
    ),
    Rule(
        *("18", ERROR, ""),
        "The binary writes to descriptors that it did not open.",
        "Do not use the FMU: a simulation model has no reason to do this.",
    ),
    Rule(
        *("18", WARNING, ""),
        "The binary asks for the network, another process or program, power over others, or a change of the system.",
        "Ask its author why. A check denies it, so an FMU that needs it cannot be checked further.",
    ),
    Rule(
        *("18", NOTE, ""),
        "The binary leaves files in its working directory or among its temporary files.",
        "Expect such files where the FMU runs.",
    ),
    Rule(
        *(ROLE, ERROR, ""),
        "The FMU lacks a signal of its role, or has it with another causality, type or physical unit.",
        "Rename the variable, use `--map`, or declare the unit that is needed.",
    ),
    Rule(
        *(ROLE, WARNING, ""),
        "A unit cannot be compared, an input is not driven by anything, or there is no sampling period to set.",
        "Declare the unit with its BaseUnit; connect or remove the input; add the parameter `sample_time`.",
    ),
    Rule(
        *(ROLE, NOTE, ""),
        "A signal that only readers need is missing, or a unit is converted.",
        "Nothing must be done.",
    ),
    Rule(
        *(LOOP, ERROR, ""),
        "The controller does not fit into the closed loop, ends its process, fails in the loop, or lets it diverge.",
        "Compare with the shipped controller: signs, units, order of joints.",
    ),
    Rule(
        *(LOOP, WARNING, ""),
        "The tip misses its trajectory by more than with the shipped controller, or a torque exceeds its limit.",
        "Compare the numbers side by side; a difference that appears only at the wall comes from F_hat.",
    ),
    Rule(
        *(LOOP, NOTE, ""),
        "A mapped name belongs to no variable of the loop's own controller.",
        "Nothing must be done.",
    ),
)
"""All kinds of findings, in the order of the checklist."""


def rule_of(id_: str, severity: Severity) -> Rule | None:
    """Return the rule with an id and a severity; None for a rule that a caller's own trial has added."""
    return next((rule for rule in RULES if (rule.id, rule.severity) == (id_, severity)), None)
