"""The desk: a page on which a run is watched, steered and scrubbed (docs/desk.md). store.py holds signals so that a window of
any length is drawn at the cost of its pixels; source.py fills it from a recorded log, a growing one or the bus; charts.py says what
is drawn; access.py who may watch and who has the joystick; steered_run.py is the run that a page steers; server.py serves the page."""
