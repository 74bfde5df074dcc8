"""A PLC as the controller: the wire's signals as registers, nodes or symbols (docs/plc.md)."""
