"""The command line of a Python program of slewlab: an option that is not known is answered with the one that is near."""

import argparse
import difflib
import sys


class ArgumentParser(argparse.ArgumentParser):
    def parse_args(self, args=None, namespace=None):
        known = [name for name in self._option_string_actions if name.startswith("--")]
        words = sys.argv[1:] if args is None else list(args)
        for word in words[:words.index("--")] if "--" in words else words:
            name = str(word).partition("=")[0]
            if not name.startswith("--") or any(option.startswith(name) for option in known):
                continue
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.7)
            others = f"one of {', '.join(known)}"
            self.error(f"'{name}' is no option of it, expected " + (f"'{near[0]}' (or {others})" if near else others))
        return super().parse_args(args, namespace)
