"""slewlab in Python: machines, scenarios and logs, with the C++ core in this process.

>>> import slewlab
>>> scenario = slewlab.Scenario(slewlab.config("scenarios/thesis_slew.yaml"), {"crane.load.mass": "60 t"})
>>> run = scenario.run()
>>> run["SENSORS"].tip_acceleration.abs().max()  # [m/s^2]

SI units throughout. A table carries its units in `table.attrs["units"]`, {column: unit}.
"""

from ._core import Answer, Encoder, InputError, Mode, Operator, __version__
from ._log import LogError
from .campaigns import CampaignMismatch, JournalDamaged, campaign, read_table
from .control import Margins, StateSpace, margins
from .figures import overview, report_figures
from .files import check, config, values
from .findings import CannotTell, Cause, Diagnosis, Remainder, Size, diagnose, read_diagnosis
from .machine import Machine
from .program import ProgramFailed
from .scenario import Controller, Run, Scenario
from .sweep import measures, monte_carlo, sweep
from .tables import Log, factor, open_log

__all__ = ["Answer", "CampaignMismatch", "CannotTell", "Cause", "Controller", "Diagnosis", "Encoder", "InputError", "JournalDamaged", "Log",
           "LogError", "Machine", "Margins", "Mode", "Operator", "ProgramFailed", "Remainder", "Run", "Scenario", "Size", "StateSpace",
           "__version__", "campaign", "check", "config", "diagnose", "factor", "margins", "measures", "monte_carlo", "open_log", "overview",
           "read_diagnosis", "read_table", "report_figures", "sweep", "values"]
