"""Tests install-packages with stand-ins for Debian's commands."""

import os
import pathlib
import subprocess
import tempfile
import unittest

INSTALL_PACKAGES = pathlib.Path(__file__).resolve().parents[2] / "toolchain/install-packages"

# Fails as often as the file `failures` has lines, with the first of its lines; then records its arguments.
APT_GET = """#!/bin/sh
if [ -s failures ]; then
  head -n 1 failures >&2
  sed -i 1d failures
  exit 100
fi
echo "$*" >>calls
"""
LOCKED = "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 8332 (unattended-upgr)"


def install(*failures):
    """Returns the finished process and the calls of apt-get that succeeded."""
    with tempfile.TemporaryDirectory() as folder:
        scripts = {"apt-get": APT_GET, "dpkg-query": "#!/bin/sh\nexit 1\n", "sleep": "#!/bin/sh\n",
                   "sudo": '#!/bin/sh\nexec "$@"\n'}
        for name, script in scripts.items():
            file = pathlib.Path(folder, name)
            file.write_text(script, encoding="utf-8")
            file.chmod(0o755)
        pathlib.Path(folder, "failures").write_text("".join(line + "\n" for line in failures), encoding="utf-8")
        done = subprocess.run([INSTALL_PACKAGES, "mandoc"], cwd=folder, check=False, capture_output=True, text=True,
                              env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})
        calls = pathlib.Path(folder, "calls")
        return done, calls.read_text(encoding="utf-8").splitlines() if calls.exists() else []


class InstallPackages(unittest.TestCase):
    def test_a_lock_is_waited_for_and_announced_once(self):
        done, calls = install(LOCKED, LOCKED, LOCKED)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, "installing mandoc\nwaiting for apt: /var/lib/apt/lists/lock. "
                                      "It is held by process 8332 (unattended-upgr)\n")
        self.assertEqual(calls, ["-qq update", "-qq install -y --no-install-recommends mandoc"])

    def test_another_error_ends_the_installation(self):
        done, calls = install("E: Unable to locate package mandoc")
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stderr, "E: Unable to locate package mandoc\n")
        self.assertEqual(calls, [])


if __name__ == "__main__":
    unittest.main()
