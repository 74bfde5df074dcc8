"""The numbers that docs quote from config/ are those of config/; the page of dependencies has what is installed."""

import re
import unittest

import yaml

from run_log import REPOSITORY

QUOTES = (
    ("docs/model.md", "controllers", "motor_torque_rated", 1, "**T100 = {:g} Nm** per motor"),
    ("docs/model.md", "controllers", "ramp.top_speed", 1, "**Top speed {:g} rad/s, "),
    ("docs/model.md", "controllers", "ramp.acceleration_time", 1, "rad/s, {:g} s, "),
    ("docs/model.md", "controllers", "ramp.curved_share", 100, ", {:g} % curved at each end"),
    ("docs/model.md", "controllers", "ramp.emergency_stop_time", 1, "emergency stop in {:g} s**"),
    ("docs/model.md", "controllers", "speed_control.proportional_gain", 1, "**Speed loop: {:g} Nm·s/rad"),
    ("docs/model.md", "controllers", "speed_control.integral_time", 1, "Nm·s/rad and {:g} s per motor.**"),
    ("docs/model.md", "cranes", "boom.damping_ratio", 100, "**Boom damping {:g} %**"),
    ("docs/model.md", "cranes", "boom.torsion_constant", 1, "I_t = {:g} m⁴"),
    ("docs/model.md", "cranes", "boom.angle", 57.29577951308232, "at a boom angle of {:.4g}°"),
    ("docs/model.md", "cranes", "load.rod_length", 1, "**Rod {:g} m**"),
    ("docs/model.md", "cranes", "house.sensor_radius", 1, "**House sensor {:g} m** from the axis"),
    ("docs/model.md", "cranes", "boom.profile.half_width", 1, "| half width [m] | {:.4g} | {:.4g} | {:.4g} | {:.4g} | {:.4g} | {:.4g} |"),
    ("docs/model.md", "cranes", "boom.profile.half_height", 1, "| half height [m] | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |"),
    ("docs/drive.md", "cranes", "drive_protection.brake.torque", 1, "brakes of {:g} N m stop"),
)


def value_of(folder, key):
    node = yaml.safe_load((REPOSITORY / "config" / folder / "thesis.yaml").read_text(encoding="utf-8"))
    for part in key.split("."):
        node = node[part]
    values = node["value"] if isinstance(node["value"], list) else [node["value"]]
    return values, node["unit"]


def installed():
    """The packages of Debian and PyPI that tools/setup, tools/test and a wheel's build install."""
    setup = (REPOSITORY / "tools" / "setup").read_text(encoding="utf-8")
    debian = re.search(r'packages="(.*?)\$', setup, re.DOTALL).group(1).split()
    for script in ("test", "fuzz"):
        more = re.search(r'SLEWLAB_MORE_PACKAGES="([\w -]+)', (REPOSITORY / "tools" / script).read_text(encoding="utf-8"))
        debian += more.group(1).split()
    python = re.findall(r'"([\w-]+)==', (REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
    for name in ("requirements.txt", "requirements_development.txt"):
        python += re.findall(r"^([\w-]+)==", (REPOSITORY / "tools" / "python" / name).read_text(encoding="utf-8"), re.MULTILINE)
    return debian, python


class DocsNumbersTest(unittest.TestCase):
    def test_docs_quote_config_as_it_is(self):
        for page, folder, key, factor, words in QUOTES:
            with self.subTest(page=page, key=key):
                values, unit = value_of(folder, key)
                quoted = words.format(*(float(v) * SI.get(unit, 1.0) * factor for v in values))
                self.assertIn(quoted, (REPOSITORY / page).read_text(encoding="utf-8"))

    def test_the_page_of_dependencies_has_every_package(self):
        page = (REPOSITORY / "docs" / "dependencies.md").read_text(encoding="utf-8")
        named, words = set(re.findall(r"`([\w.+-]+)`", page)), set(re.findall(r"[a-z][\w-]*", page.lower()))
        debian, python = installed()
        self.assertGreater(min(len(debian), len(python)), 15)
        self.assertEqual([package for package in debian if package not in named], [])
        self.assertEqual([package for package in python if package not in words and f"python-{package}" not in words], [])


SI = {"%": 1e-2, "deg": 0.017453292519943295, "ms": 1e-3, "kN m": 1e3, "mm": 1e-3}

if __name__ == "__main__":
    unittest.main()
