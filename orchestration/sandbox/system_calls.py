"""A seccomp filter that denies a process the system calls by which it would reach out of itself.

Denied are sockets, programs, other processes and their memory, mounts, modules, clocks, owners, permissions and
times of files. What a library needs to compute is allowed: threads, memory, files, signals within the process.
A denied call fails with EPERM, as for a user without the right, so that the caller can go on. Where the kernel can
tell another process of denied calls (Linux 5.7), that process gives the answer; see `orchestration.sandbox.denials`.

The filter is a program for the kernel (classic BPF, see seccomp(2)): each instruction has a code, the numbers of
instructions to skip if a comparison holds and if not, and a constant.
"""

import ctypes
import errno
import os
import platform
import struct
import sys
from collections.abc import Iterator

# Numbers of denied calls on x86-64 and on ARM; None where the processor has no such call.
DENIED: dict[str, tuple[int | None, int | None]] = {
    "socket": (41, 198),
    "execve": (59, 221),
    "execveat": (322, 281),
    "fork": (57, None),
    "vfork": (58, None),
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "process_madvise": (440, 440),
    "process_mrelease": (448, 448),
    "tkill": (200, 130),
    "rt_sigqueueinfo": (129, 138),
    "rt_tgsigqueueinfo": (297, 240),
    "pidfd_open": (434, 434),
    "pidfd_getfd": (438, 438),
    "pidfd_send_signal": (424, 424),
    "kcmp": (312, 272),
    "seccomp": (317, 277),
    "setsid": (112, 157),
    "setpgid": (109, 154),
    "setpriority": (141, 140),
    "ioprio_set": (251, 30),
    "migrate_pages": (256, 238),
    "move_pages": (279, 239),
    "shmget": (29, 194),
    "shmat": (30, 196),
    "msgget": (68, 186),
    "semget": (64, 190),
    "mq_open": (240, 180),
    "mount": (165, 40),
    "umount2": (166, 39),
    "pivot_root": (155, 41),
    "chroot": (161, 51),
    "unshare": (272, 97),
    "setns": (308, 268),
    "open_tree": (428, 428),
    "move_mount": (429, 429),
    "fsopen": (430, 430),
    "fsconfig": (431, 431),
    "fsmount": (432, 432),
    "fspick": (433, 433),
    "mount_setattr": (442, 442),
    "swapon": (167, 224),
    "swapoff": (168, 225),
    "reboot": (169, 142),
    "init_module": (175, 105),
    "finit_module": (313, 273),
    "delete_module": (176, 106),
    "kexec_load": (246, 104),
    "kexec_file_load": (320, 294),
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "userfaultfd": (323, 282),
    "io_uring_setup": (425, 425),
    "io_uring_enter": (426, 426),
    "io_uring_register": (427, 427),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "keyctl": (250, 219),
    "settimeofday": (164, 170),
    "clock_settime": (227, 112),
    "adjtimex": (159, 171),
    "clock_adjtime": (305, 266),
    "sethostname": (170, 161),
    "setdomainname": (171, 162),
    "iopl": (172, None),
    "ioperm": (173, None),
    "quotactl": (179, 60),
    "quotactl_fd": (443, 443),
    "acct": (163, 89),
    "vhangup": (153, 58),
    "syslog": (103, 116),
    "fanotify_init": (300, 262),
    "open_by_handle_at": (304, 265),
    "mknod": (133, None),
    "mknodat": (259, 33),
    "chmod": (90, None),
    "fchmod": (91, 52),
    "fchmodat": (268, 53),
    "fchmodat2": (452, 452),
    "chown": (92, None),
    "fchown": (93, 55),
    "lchown": (94, None),
    "fchownat": (260, 54),
    "utime": (132, None),
    "utimes": (235, None),
    "futimesat": (261, None),
    "utimensat": (280, 88),
    "setxattr": (188, 5),
    "lsetxattr": (189, 6),
    "fsetxattr": (190, 7),
    "setxattrat": (463, 463),
    "removexattr": (197, 14),
    "lremovexattr": (198, 15),
    "fremovexattr": (199, 16),
    "removexattrat": (466, 466),
}
# Calls whose arguments decide.
JUDGED: dict[str, tuple[int, int]] = {
    "kill": (62, 129),
    "tgkill": (234, 131),
    "prlimit64": (302, 261),
    "clone": (56, 220),
    "clone3": (435, 435),
    "fcntl": (72, 25),
    "ioctl": (16, 29),
    "prctl": (157, 167),
}
_MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}  # column in the tables, AUDIT_ARCH
_X32 = 0x40000000  # calls of x86-64 with addresses of 32 bits have numbers from here on
_CLONE_THREAD = 0x10000
_SIGNAL_OWNERS = (8, 10, 15)  # F_SETOWN, F_SETSIG, F_SETOWN_EX: signals to other processes
_TYPE_AHEAD = (0x5412,)  # TIOCSTI: types on a terminal
_LOOSENING = (1, 22)  # PR_SET_PDEATHSIG: outlives its parent; PR_SET_SECCOMP: a filter above this one
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16  # places in what the kernel gives a filter
_ALLOW, _ERROR, _KILL, _TELL = 0x7FFF0000, 0x00050000, 0x80000000, 0x7FC00000
_SET_MODE_FILTER = 1
_ALL_THREADS, _NEW_LISTENER, _ALL_THREADS_OR_ERROR = 1, 8, 16

Instruction = tuple[int, int, int, int]


def deny_reaching_out(libc: ctypes.CDLL) -> bool:
    """Install the filter in all threads of this process, for ever; returns whether the kernel did.

    The process must have given up new privileges before (``PR_SET_NO_NEW_PRIVS``).

    Parameters
    ----------
    libc
        The C library, loaded with ``use_errno``.
    """
    return _install(libc, (_ERROR | errno.EPERM), _ALL_THREADS) == 0


def deny_and_tell(libc: ctypes.CDLL) -> int | None:
    """Install the filter, and let another process answer denied calls, which wait for the answer.

    Returns
    -------
    int or None
        Descriptor from which `orchestration.sandbox.denials` reads the calls; None if the kernel does not offer that,
        and then no filter is installed.
    """
    listener = _install(libc, _TELL, _NEW_LISTENER | _ALL_THREADS | _ALL_THREADS_OR_ERROR)
    return None if listener < 0 else listener


def known_calls() -> dict[int, str]:
    """Return the names of the calls that the filter may deny on this machine, by number."""
    column, _ = _MACHINES.get(platform.machine(), (0, 0))
    numbers = {name: row[column] for name, row in {**DENIED, **JUDGED}.items()}
    return {number: name for name, number in numbers.items() if number is not None}


def _install(libc: ctypes.CDLL, refusal: int, flags: int) -> int:
    """Install the filter with an answer to denied calls; returns what the kernel returned, -1 if it was not asked."""
    machine = platform.machine()
    if not sys.platform.startswith("linux") or machine not in _MACHINES or sys.maxsize < 2**32:
        return -1
    instructions = list(_program(machine, os.getpid(), refusal))
    code = b"".join(struct.pack("=HBBI", *instruction) for instruction in instructions)
    buffer = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("@HP", len(instructions), ctypes.addressof(buffer))
    column, _ = _MACHINES[machine]
    return libc.syscall(DENIED["seccomp"][column], _SET_MODE_FILTER, flags, program)


def _program(machine: str, process: int, refusal: int) -> Iterator[Instruction]:
    """Yield the instructions of the filter for a machine, a process by its id, and the answer to denied calls."""
    refuse = _RETURN, 0, 0, refusal
    column, architecture = _MACHINES[machine]
    yield _LOAD, 0, 0, _ARCHITECTURE
    yield _EQUAL, 1, 0, architecture
    yield _RETURN, 0, 0, _KILL
    yield _LOAD, 0, 0, _NUMBER
    if machine == "x86_64":
        yield _AT_LEAST, 0, 1, _X32
        yield _RETURN, 0, 0, _ERROR | errno.ENOSYS
    for numbers in DENIED.values():
        if (number := numbers[column]) is not None:
            yield _EQUAL, 0, 1, number
            yield refuse
    number = {name: numbers[column] for name, numbers in JUDGED.items()}
    yield _EQUAL, 0, 1, number["clone3"]  # its flags are behind an address; C libraries then take clone
    yield _RETURN, 0, 0, _ERROR | errno.ENOSYS
    yield _EQUAL, 0, 4, number["clone"]
    yield _LOAD, 0, 0, _ARGUMENTS
    yield _ANY_BIT, 0, 1, _CLONE_THREAD
    yield _RETURN, 0, 0, _ALLOW
    yield refuse
    allow = _RETURN, 0, 0, _ALLOW
    for name, values in (("kill", (process,)), ("tgkill", (process,)), ("prlimit64", (0, process))):
        yield from _judged(number[name], 0, values, allow, refuse)
    for name, place, values in (("fcntl", 1, _SIGNAL_OWNERS), ("ioctl", 1, _TYPE_AHEAD), ("prctl", 0, _LOOSENING)):
        yield from _judged(number[name], place, values, refuse, allow)
    yield allow


def _judged(
    number: int, argument: int, values: tuple[int, ...], answer: Instruction, otherwise: Instruction
) -> Iterator[Instruction]:
    """Yield instructions that answer a call if the lower half of an argument is one of some values, and if not."""
    yield _EQUAL, 0, 2 * len(values) + 2, number
    yield _LOAD, 0, 0, _ARGUMENTS + 8 * argument
    for value in values:
        yield _EQUAL, 0, 1, value
        yield answer
    yield otherwise
