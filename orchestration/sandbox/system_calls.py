"""A seccomp filter that denies a process the system calls by which it would reach out of itself.

Denied are sockets, programs, other processes and their memory, mounts, modules, clocks, owners, permissions and
times of files. What a library needs to compute is allowed: threads, memory, files, signals within the process.
A denied call fails with EPERM, as for a user without the right, so that the caller can go on.

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
}
_MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}  # column in the tables, AUDIT_ARCH
_X32 = 0x40000000  # calls of x86-64 with addresses of 32 bits have numbers from here on
_CLONE_THREAD = 0x10000
_SIGNAL_OWNERS = (8, 10, 15)  # F_SETOWN, F_SETSIG, F_SETOWN_EX: signals to other processes
_TYPE_AHEAD = (0x5412,)  # TIOCSTI: types on a terminal
_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _ARGUMENTS = 0, 4, 16  # places in what the kernel gives a filter
_ALLOW, _ERROR, _KILL = 0x7FFF0000, 0x00050000, 0x80000000
_SET_MODE_FILTER, _ALL_THREADS = 1, 1
_SECCOMP = {"x86_64": 317, "aarch64": 277}

Instruction = tuple[int, int, int, int]


def deny_reaching_out(libc: ctypes.CDLL) -> bool:
    """Install the filter in all threads of this process, for ever; returns whether the kernel did.

    The process must have given up new privileges before (``PR_SET_NO_NEW_PRIVS``).

    Parameters
    ----------
    libc
        The C library, loaded with ``use_errno``.
    """
    machine = platform.machine()
    if not sys.platform.startswith("linux") or machine not in _MACHINES or sys.maxsize < 2**32:
        return False
    instructions = list(_program(machine, os.getpid()))
    code = b"".join(struct.pack("=HBBI", *instruction) for instruction in instructions)
    buffer = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("@HP", len(instructions), ctypes.addressof(buffer))
    return libc.syscall(_SECCOMP[machine], _SET_MODE_FILTER, _ALL_THREADS, program) == 0


def _program(machine: str, process: int) -> Iterator[Instruction]:
    """Yield the instructions of the filter for a machine and a process by its id."""
    column, architecture = _MACHINES[machine]
    yield _LOAD, 0, 0, _ARCHITECTURE
    yield _EQUAL, 1, 0, architecture
    yield _RETURN, 0, 0, _KILL
    yield _LOAD, 0, 0, _NUMBER
    if machine == "x86_64":
        yield _AT_LEAST, 0, 1, _X32
        yield _refusal(errno.ENOSYS)
    for numbers in DENIED.values():
        if (number := numbers[column]) is not None:
            yield _EQUAL, 0, 1, number
            yield _refusal(errno.EPERM)
    number = {name: numbers[column] for name, numbers in JUDGED.items()}
    yield _EQUAL, 0, 1, number["clone3"]  # its flags are behind an address; C libraries then take clone
    yield _refusal(errno.ENOSYS)
    for name in ("kill", "tgkill"):
        yield from _only_with(number[name], 0, (process,))
    yield from _only_with(number["prlimit64"], 0, (0, process))
    yield _EQUAL, 0, 4, number["clone"]
    yield _LOAD, 0, 0, _ARGUMENTS
    yield _ANY_BIT, 0, 1, _CLONE_THREAD
    yield _RETURN, 0, 0, _ALLOW
    yield _refusal(errno.EPERM)
    for name, forbidden in (("fcntl", _SIGNAL_OWNERS), ("ioctl", _TYPE_AHEAD)):
        yield from _never_with(number[name], 1, forbidden)
    yield _RETURN, 0, 0, _ALLOW


def _refusal(error: int) -> Instruction:
    return _RETURN, 0, 0, _ERROR | error


def _only_with(number: int, argument: int, values: tuple[int, ...]) -> Iterator[Instruction]:
    """Yield instructions that refuse a call unless the lower half of an argument is one of some values."""
    yield _EQUAL, 0, 2 * len(values) + 2, number
    yield _LOAD, 0, 0, _ARGUMENTS + 8 * argument
    for value in values:
        yield _EQUAL, 0, 1, value
        yield _RETURN, 0, 0, _ALLOW
    yield _refusal(errno.EPERM)


def _never_with(number: int, argument: int, values: tuple[int, ...]) -> Iterator[Instruction]:
    """Yield instructions that refuse a call if the lower half of an argument is one of some values."""
    yield _EQUAL, 0, 2 * len(values) + 2, number
    yield _LOAD, 0, 0, _ARGUMENTS + 8 * argument
    for value in values:
        yield _EQUAL, 0, 1, value
        yield _refusal(errno.EPERM)
    yield _RETURN, 0, 0, _ALLOW
