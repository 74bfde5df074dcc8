"""Scheduling for what keeps the wall clock, as the plant asks for it (sim/drive/system_clock.h)."""

import os

PRIORITY = 48  # below the plant's 49: whoever computes the machine comes first


def ask_for_real_time():
    """One line that says whether it was permitted, and what would permit it."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except OSError as problem:
        return f"SCHED_FIFO: no ({problem.strerror}): deadlines depend on what else runs here; root, CAP_SYS_NICE or 'ulimit -r 50' permit it"
    return f"SCHED_FIFO: yes, priority {PRIORITY}"
