"""Builds tests with a changed source and runs them. The source tree is not changed: the changed file is in a separate
folder, which the compiler searches first."""

import concurrent.futures
import hashlib
import os
import re
import shutil
import subprocess
import threading

from programs import ROOT

BUILD = ROOT / "build/mutation"
COMPILE = ["clang++", "-std=c++17", "-w", "-fno-ident"]
LINKED = ["-lgtest", "-lgtest_main", "-l:libyaml-cpp.a", "-pthread"]
MOST_MEMORY = 4 << 30  # limit in bytes; a program that exceeds it fails


def run(command, folder=ROOT, **environment):
    silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    variables = {**os.environ, **environment}
    return subprocess.run([*map(str, command)], cwd=folder, env=variables, check=False, **silent).returncode == 0


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def digest_of_text(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def options_of_header(unit):
    """Returns the options that must be the same for a unit and for the precompiled header of the unit."""
    return [option for option in unit.options if not option.startswith(("-I", "-D"))]


def header_of(unit):
    """Returns the path of the header that the unit includes first. The header is precompiled to save time."""
    return BUILD / f"{digest_of_text(' '.join([*options_of_header(unit), *unit.headers]))}.hpp"


def compiled(unit, folder, overlay=None):
    """Compiles `unit` in `folder`. Returns the object file, or None if the unit does not compile."""
    source = folder / f"{unit.name}.cpp"
    source.write_text("".join(f'#include "{each}"\n' for each in unit.sources))
    target = folder / f"{unit.name}.o"
    first = [f"-I{overlay}"] if overlay else []
    header = ["-include", header_of(unit)]
    if not run([*COMPILE, *first, *unit.options, "-I.", *header, "-c", source, "-o", target]):
        return None
    # The debug information and the name of the source can differ although the code is the same.
    run(["objcopy", "--strip-debug", "--remove-section=.comment", f"--strip-symbol={source.name}", target])
    return target


class Workshop:
    """The builds of the unchanged tree. Each is built once, on first use."""

    def __init__(self):
        shutil.rmtree(BUILD, ignore_errors=True)
        BUILD.mkdir(parents=True)
        self.lock = threading.Lock()
        self.locks = {}
        self.built = {}

    def once(self, key, build):
        with self.lock:
            lock = self.locks.setdefault(key, threading.Lock())
        with lock:
            if key not in self.built:
                self.built[key] = build()
            return self.built[key]

    # --- units ---

    def header(self, unit):
        def build():
            header = header_of(unit)
            header.write_text("".join(f"#include <{each}>\n" for each in unit.headers))
            return run([*COMPILE, *options_of_header(unit), "-xc++-header", header, "-o", f"{header}.gch"])

        return self.once(("header", header_of(unit)), build)

    def unit(self, unit):
        """Returns the object file of the unit, and the digest that identifies it."""

        def build():
            self.header(unit)
            target = compiled(unit, BUILD)
            if target is None:
                raise SystemExit(f"mutate: {unit.name} does not compile; build the preset host-debug to see why")
            return target, digest(target)

        return self.once(("unit", unit.name), build)

    # --- programs ---

    def program(self, program):
        """Returns the units that the linker takes. Exits if the program fails on the unchanged tree."""

        def build():
            libraries = [unit for unit in program.units if unit.name in program.libraries]
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                list(pool.map(self.unit, program.units))
            archives = [self.archive(unit) for unit in libraries]
            tests = [self.unit(unit)[0] for unit in program.tests]
            place = BUILD / program.name.replace(" ", "-")
            members = place.with_suffix(".map")
            command = ["clang++", *tests, f"-Wl,-Map={members}", "-Wl,--start-group", *archives, "-Wl,--end-group"]
            linked = subprocess.run(
                [*map(str, command), "-o", str(place), *LINKED, *program.options],
                cwd=ROOT,
                capture_output=True,
                check=False,
                text=True,
            )
            for image in program.images:
                self.image(image)
            if linked.returncode != 0 or not self.passes(program, place, BUILD):
                raise SystemExit(f"mutate: {program.name} fails on the unchanged tree\n{linked.stderr[-2000:]}")
            taken = set(re.findall(r"\.a\(([^)]+)\.o\)", members.read_text()))
            return [*program.tests, *(unit for unit in libraries if unit.name in taken)]

        return self.once(("program", program.name), build)

    def archive(self, unit):
        def build():
            archive = BUILD / f"{unit.name}.a"
            run(["ar", "rcs", archive, self.unit(unit)[0]])
            return archive

        return self.once(("archive", unit.name), build)

    def image(self, image):
        def build():
            place = BUILD / "images"
            place.mkdir(exist_ok=True)
            for command in image.commands(place, self.unit(image.unit)[0], None):
                run(command)
            return place

        return self.once(("image", image.name), build)

    @staticmethod
    def passes(program, place, folder):
        # A mutant can make a test wait for ever without using the processor. Only the limit of 600 s detects this.
        limits = ["timeout", "--foreground", "--signal=KILL", "600", "prlimit", f"--cpu={program.processor_seconds}",
                  f"--as={MOST_MEMORY}"]
        return run(
            [*limits, place, "--gtest_brief=1", "--gtest_fail_fast"],
            folder if program.images else ROOT,
            TMPDIR=str(folder),
            **dict(program.environment),
        )


class Bench:
    """A mutant and its builds, in a folder that the caller removes."""

    def __init__(self, workshop, folder, file, changed):
        self.workshop = workshop
        self.folder = folder
        self.file = file
        self.objects = {}
        self.images = set()
        place = folder / file
        place.parent.mkdir(parents=True)
        place.write_text(changed)

    def is_in(self, unit):
        return self.file in unit.files

    def object_of(self, unit):
        """Returns the object file of the unit, or None if the unit does not compile."""
        if not self.is_in(unit):
            return self.workshop.unit(unit)[0]
        if unit.name not in self.objects:
            self.objects[unit.name] = compiled(unit, self.folder, self.folder)
        return self.objects[unit.name]

    def changes(self, units):
        """Compiles the units that contain the changed file, one after the other. Stops and returns True after the first
        unit whose object code the mutant changes. Stops and returns False after the first unit that does not compile.
        Returns False if the mutant changes the object code of no unit."""
        for unit in filter(self.is_in, units):
            _, as_it_is = self.workshop.unit(unit)
            changed = self.object_of(unit)
            if changed is None:
                return False
            if digest(changed) != as_it_is:
                return True
        return False

    def units_of(self, program):
        return [*self.workshop.program(program), *(image.unit for image in program.images)]

    def compiles(self, program):
        return all(self.object_of(unit) is not None for unit in self.units_of(program))

    def differs(self, program):
        """Returns whether any object code of the program differs from that of the unchanged tree."""
        changed = filter(self.is_in, self.units_of(program))
        return any(digest(self.object_of(unit)) != self.workshop.unit(unit)[1] for unit in changed)

    def passes(self, program):
        place = self.folder / "program"
        objects = [self.object_of(unit) for unit in self.workshop.program(program)]
        for image in program.images:
            self.make(image)
        command = ["clang++", *objects, "-o", place, *LINKED, *program.options]
        if not run(command):
            raise SystemExit(f"mutate: {program.name} does not link with {self.file}")
        return self.workshop.passes(program, place, self.folder)

    def make(self, image):
        place = self.folder / "images"
        place.mkdir(exist_ok=True)
        if image.name not in self.images:
            self.images.add(image.name)
            for command in image.commands(place, self.object_of(image.unit), self.folder):
                run(command)
