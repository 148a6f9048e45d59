"""Sentences in JavaScript come out as C prints them, digit for digit."""

import ctypes
import json
import math
import random
import struct
import sys
from pathlib import Path

import pytest

from orchestration.containers.wasm.module import host
from tests.interop.wasm.node import needs_node, script_output

pytestmark = [
    needs_node,
    pytest.mark.skipif(sys.platform != "linux", reason="elsewhere Python does not reach C's printf in this way"),
]
CONVERSIONS = ("%.17g", "%g", "%.3g", "%.1g", "%.0g")


def numbers() -> list[float]:
    """Bounds of the notations, exact halves, all exponents, and times of runs."""
    source = random.Random(1)
    anyhow = [struct.unpack("d", source.randbytes(8))[0] for _ in range(3000)]
    halves = [k * 2.0**-j for k in (1, 3, 5, 7, 11, 2001) for j in range(60)]
    turns = [s * 10.0**e for e in range(-7, 20) for s in (1, 9.5, 9.4999999, 9.99995, 99999.95)]
    special = [0.0, -0.0, math.inf, -math.inf, 5e-324, sys.float_info.max, 0.5, 1.5, 2.5, 1234565.0, 1234575.0]
    return [*special, *halves, *turns, *(k * 1e-4 for k in range(3000)), *(x for x in anyhow if x == x)]


def printed(conversion: str, value: float) -> str:
    """What the C library of this machine prints."""
    text = ctypes.create_string_buffer(64)
    snprintf = ctypes.CDLL(None).snprintf
    snprintf.argtypes = [ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p]
    snprintf(text, 64, conversion.encode(), ctypes.c_double(value))
    return text.value.decode()


def in_javascript(folder: Path, calls: list[tuple[str, list[float | str]]]) -> list[str]:
    """What the host makes of sentences and their arguments; numbers go to it as the texts of their bits."""
    (folder / "system.mjs").write_bytes(host())
    bits = [[s, [struct.pack(">d", v).hex() if isinstance(v, float) else [v] for v in values]] for s, values in calls]
    (folder / "calls.json").write_text(json.dumps(bits))
    script = """
    import { readFileSync } from "node:fs";
    import { formatted } from "./system.mjs";
    const value = (v) => (typeof v === "string" ? Buffer.from(v, "hex").readDoubleBE() : v[0]);
    const calls = JSON.parse(readFileSync("calls.json"));
    console.log(JSON.stringify(calls.map(([sentence, values]) => formatted(sentence, values.map(value)))));
    """
    return script_output(folder, script)


@pytest.mark.parametrize("conversion", CONVERSIONS)
def test_numbers_are_printed_as_in_c(conversion: str, tmp_path: Path) -> None:
    values = numbers()
    said = in_javascript(tmp_path, [(conversion, [value]) for value in values])
    wrong = [(v, s, printed(conversion, v)) for v, s in zip(values, said, strict=True) if s != printed(conversion, v)]
    assert len(values) > 6000
    assert not wrong


def test_sentences_keep_their_order_and_their_percent_signs(tmp_path: Path) -> None:
    calls: list[tuple[str, list[float | str]]] = [
        ("State %s is %s at t = %.17g s; it diverges.", ["q[1]", "nan", 0.1]),
        ("%d of %u are 100 %% right: %s", [3.0, 4.0, "50 %d"]),
        ("no argument", []),
    ]
    assert in_javascript(tmp_path, calls) == [
        "State q[1] is nan at t = 0.10000000000000001 s; it diverges.",
        "3 of 4 are 100 % right: 50 %d",
        "no argument",
    ]
