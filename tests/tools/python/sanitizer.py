"""Whether the programs under test are sanitized. Their interpreter is then started with the sanitizer's runtime, which is not for programs of others."""

import os

IS_SANITIZED = "san" in os.environ.get("LD_PRELOAD", "")
ENVIRONMENT_OF_OTHERS = {name: value for name, value in os.environ.items() if name != "LD_PRELOAD"}
