"""Says what a program asks for by a system call that a confined process may not make."""

_CALLS = {
    "a socket": ("socket",),
    "another process or program": ("execve", "execveat", "fork", "vfork", "clone"),
    "power over another process, or over its own bounds": (
        *("kill", "tgkill", "tkill", "rt_sigqueueinfo", "rt_tgsigqueueinfo", "pidfd_open", "pidfd_send_signal"),
        *("fcntl", "setsid", "setpgid", "prctl", "seccomp", "setpriority", "ioprio_set", "prlimit64"),
    ),
    "the memory of another process": (
        *("ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "process_mrelease", "kcmp"),
        *("pidfd_getfd", "migrate_pages", "move_pages", "shmget", "shmat", "msgget", "semget", "mq_open"),
    ),
}
_MEANINGS = {call: meaning for meaning, calls in _CALLS.items() for call in calls}


def meaning(call: str) -> str:
    """Return what a denied system call asks for, as the end of a sentence."""
    return _MEANINGS.get(call, "a change of the system")
