"""Defines which tests check which sources, and how those tests are built.

A unit is one object file: one or more sources that are compiled together. A program is a test. It lists the library
units that it can use. Of these units, the linker takes only the units that the test requires. Most programs are read
from the CMakeLists.txt files; the functions `players`, `image_programs` and `pico_program` define the others.
"""

import dataclasses
import functools
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

SHADOW = "-Itests/mcu_model/shadow"
OBSERVED = "-Itests/support/interleaving/observed"
LONG_UPTIME = "-Itests/support/long_uptime"


def files(*patterns):
    listed = subprocess.run(["git", "ls-files", *patterns], cwd=ROOT, check=True, capture_output=True, text=True)
    return listed.stdout.split()


def stem_of(file):
    return pathlib.Path(file).stem


def standing_before(file, options):
    """Returns the file that the compiler finds for `file`: one in a folder of an option `-I`, or `file` itself."""
    for option in options:
        place = f"{option[2:]}/{file}"
        if option.startswith("-I") and (ROOT / place).exists():
            return place
    return file


@functools.lru_cache(None)
def included(file):
    """Returns the files of the tree that a file includes. All includes are relative to the root."""
    return tuple(re.findall(r'^#include "([\w./-]+)"', (ROOT / file).read_text(), re.MULTILINE))


@dataclasses.dataclass(frozen=True)
class Unit:
    name: str
    sources: tuple
    options: tuple = ("-O0",)

    @functools.cached_property
    def files(self):
        """Returns all files of the tree that the unit is compiled from."""
        found = set()
        waiting = [*self.sources]
        while waiting:
            file = standing_before(waiting.pop(), self.options)
            if file not in found and (ROOT / file).exists():
                found.add(file)
                waiting += included(file)
        return frozenset(found)

    @functools.cached_property
    def headers(self):
        """Returns the headers of other projects to precompile for the unit. These headers take long to compile. The
        header of GoogleTest is always one of them, because it includes many headers of the standard library."""
        has_json = any("#include <nlohmann/json.hpp>" in (ROOT / file).read_text() for file in self.files)
        return ("gtest/gtest.h", "nlohmann/json.hpp") if has_json else ("gtest/gtest.h",)


@dataclasses.dataclass(frozen=True)
class Image:
    """A shared object with the image of a model for a board. It runs on a register model of tests/mcu_model."""

    board: str
    model: str

    @property
    def name(self):
        return f"image_{self.board}_{self.model}"

    @property
    def unit(self):
        options = ("-O1", "-fPIC", "-fvisibility=hidden", "-fvisibility-inlines-hidden", SHADOW)
        of_the_image = (f"-Iboards/{self.board}", f'-DEX9000_MODEL="{self.model}"')
        sources = ("tests/mcu_model/image_object.cpp", *files("firmware/*.cpp"))
        return Unit(self.name, sources, options + of_the_image)

    def commands(self, folder, obj, _overlay):
        """Returns the commands that build the image in `folder`. `obj`: the object file of `unit`."""
        return [["clang++", "-shared", obj, "-o", folder / f"{self.name}.so"]]


@dataclasses.dataclass(frozen=True)
class PicoImage:
    """The content of the flash of a Pico. `unit` is compiled for the host. It does not run, and only shows which
    mutants change the image."""

    preset: str
    model: str
    defined: tuple = ()

    @property
    def name(self):
        return f"{self.preset}_{self.model}"

    @property
    def unit(self):
        options = ("-O1", SHADOW, "-Iboards/pico", f'-DEX9000_MODEL="{self.model}"', *self.defined)
        return Unit(self.name, ("boards/rp2040/composition.cpp",), options)

    def commands(self, folder, _obj, overlay):
        place = folder / self.preset
        place.mkdir(exist_ok=True)
        elf = place / f"{self.model}.elf"
        sources = ["boards/rp2040/composition.cpp", "boards/rp2040/start_up.cpp", "boards/rp2040/second_stage.cpp",
                   "boards/memory_functions.cpp", *files("firmware/*.cpp")]
        whole = place / f"{self.model}.cpp"
        whole.write_text("".join(f'#include "{each}"\n' for each in sources))
        options = ["-mcpu=cortex-m0plus", "-mthumb", "-std=c++17", "-O2", "-w", "-ffreestanding", "-fwhole-program",
                   "-fno-exceptions", "-fno-rtti", "-fno-threadsafe-statics", "-fno-tree-loop-distribute-patterns",
                   "-fno-jump-tables", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables",
                   "-ffunction-sections", "-fdata-sections", f'-DEX9000_MODEL="{self.model}"', *self.defined]
        linked = ["-nostdlib", "-Wl,--gc-sections", "-Wl,-T,boards/pico/image.ld", "-Lboards"]
        search = [f"-I{overlay}"] if overlay else []
        return [
            ["arm-none-eabi-g++", *options, *search, "-I.", "-Iboards/pico", *linked, whole, "-o", elf, "-lgcc"],
            ["toolchain/seal-second-stage", elf],
            ["arm-none-eabi-objcopy", "-O", "binary", elf, place / f"{self.model}.bin"],
        ]


@dataclasses.dataclass(frozen=True)
class Program:
    name: str
    tests: tuple  # units
    libraries: tuple  # names of units
    environment: tuple = ()
    images: tuple = ()
    options: tuple = ()
    processor_seconds: int = 8  # limit, several times the normal processor time; a program that exceeds it fails

    @property
    def sources(self):
        return [source for unit in self.tests for source in unit.sources]

    @functools.cached_property
    def units(self):
        """Returns the units of the tests and of the images, and the library units that these require. A unit requires
        a library unit if it includes, directly or indirectly, the header of one of the sources of the library unit."""
        known = [LIBRARY_UNITS[name] for name in self.libraries]
        reached = list(self.tests) + [image.unit for image in self.images]
        for unit in reached:
            headers = {file.removesuffix(".hpp") for file in unit.files}
            for each in known:
                if each not in reached and any(HEADER_OF.get(file, file.removesuffix(".cpp")) in headers
                                               for file in each.sources):
                    reached.append(each)
        return reached


# Parts of the simulator that use sockets, files, ports or signals of the operating system. Mutation does not change
# them, because tests that run the program as a process cover most of them. The names have no folder and no extension.
PROCESS = set(
    "claim control_socket line_ports listening main panel_server port program pty_port "
    "running_line running_program serial_port stop_signals tcp_port tcp_server".split()
)
# The sources in PROCESS that only the whole program links.
WHOLE = {"main", "panel_server", "program", "running_program"}
# The generated sources with files of the tree, and the header that declares their functions. The preset host-debug must
# have been built.
EMBEDDED = {name: f"build/host-debug/sim/{name}.cpp" for name in ("export_templates", "bus_file_examples")}
HEADER_OF = {source: "sim/text/embedded_files" for source in EMBEDDED.values()}
# Sources that are compiled separately, because they take long to compile and few tests reach them. sim/CMakeLists.txt
# lists more such sources after ON_THEIR_OWN.
ALONE = {"line_record", "play_record"}


@dataclasses.dataclass(frozen=True)
class Folder:
    """A library of sim/CMakeLists.txt: the units compiled from it, and the libraries that it links publicly."""

    units: tuple
    libraries: tuple


def built(sources):
    return [each for each in sources.split() if stem_of(each) not in WHOLE]


def folders():
    text = (ROOT / "sim/CMakeLists.txt").read_text()
    found = {}
    for folder, body in re.findall(r"^ex9000_folder\(([\w/]+)\s+([^)]*)\)", text, re.MULTILINE):
        parts = dict(re.findall(r"(SOURCES|ON_THEIR_OWN|PUBLIC|PRIVATE)\s+([^A-Z]*(?:[A-Z]\w*::\w+[^A-Z]*)*)", body))
        name = folder.rsplit("/", maxsplit=1)[-1]
        sources = built(parts.get("SOURCES", ""))
        together = tuple(f"sim/{folder}/{each}" for each in sources if stem_of(each) not in ALONE)
        alone = [each for each in sources if stem_of(each) in ALONE] + built(parts.get("ON_THEIR_OWN", ""))
        options = ("-O1",) if "ex9000_hot" in parts.get("PRIVATE", "") else ("-O0",)
        units = [Unit(name, together, options)] if together else []
        units += [Unit(f"{name}-{stem_of(each)}", (f"sim/{folder}/{each}",)) for each in alone]
        libraries = tuple(re.findall(r"ex9000_(\w+)", parts.get("PUBLIC", "")))
        found[name] = Folder(tuple(units), libraries)
    for name, source in EMBEDDED.items():
        found[name] = Folder((Unit(name, (source,)),), ())
    return found


FOLDERS = folders()


def units_of(folder):
    """Returns the names of the unit `core`, of the units of a folder, and of the units of all folders whose libraries
    this folder links publicly, directly or indirectly."""
    names = ["core"]
    waiting = [folder]
    while waiting:
        known = FOLDERS.get(waiting.pop(0))
        if known:
            names += [unit.name for unit in known.units]
            waiting += known.libraries
    return tuple(dict.fromkeys(names))


def library_units():
    core = tuple(files("firmware/*.cpp"))
    others = {"image_object", "register_target"}
    mcu = [file for file in files("tests/mcu_model/*.cpp") if stem_of(file) not in others]
    return [
        Unit("core", (*core, *files("hal/doubles/*.cpp")), ("-O1",)),
        *(unit for folder in FOLDERS.values() for unit in folder.units),
        Unit("runner", ("tests/support/core_target.cpp", "tests/support/coverage.cpp"), ("-O1",)),
        Unit("mcu_model", tuple(mcu), ("-O1", SHADOW)),
        Unit("observed_core", core, ("-O1", OBSERVED)),
        Unit("long_uptime_core", core, ("-O1", LONG_UPTIME)),
    ]


LIBRARIES = {
    "ex9000_core": ("core",),
    "ex9000_doubles": ("core",),
    **{f"ex9000_{folder}": units_of(folder) for folder in FOLDERS},
    "ex9000_runner": (*units_of("play"), "runner"),
    "ex9000_mcu_model": ("mcu_model",),
    "ex9000_observed_core": ("observed_core",),
    "ex9000_long_uptime_core": ("long_uptime_core",),
}
OPTIONS = {
    "ex9000_mcu_model": (SHADOW,),
    "ex9000_observed_core": (OBSERVED,),
    "ex9000_long_uptime_core": (LONG_UPTIME,),
}
LIBRARY_UNITS = {unit.name: unit for unit in library_units()}
FILES = (f'-DEX9000_REGISTERS="{ROOT}/firmware/registers.md"',
         f'-DEX9000_STORED_BYTES="{ROOT}/tests/firmware/settings/stored_bytes"')


def test_program(name, folder, sources, libraries, shadow):
    options = ("-O0", *FILES, *shadow, *(option for library in libraries for option in OPTIONS.get(library, ())))
    unit = Unit(name, tuple(f"{folder}/{source}" for source in sources), options)
    return Program(name, (unit,), tuple(dict.fromkeys(unit for library in libraries for unit in LIBRARIES[library])))


def listed_programs(folder):
    """Returns the tests of CMakeLists.txt in `folder` that have no LABELS, link at least one library, link only
    LIBRARIES, and do not test a source of PROCESS."""
    text = (ROOT / folder / "CMakeLists.txt").read_text()
    found = []
    of_one_file = r"ex9000_test\(\$\{\w+\}_test SOURCES \$\{name\}_test\.cpp LIBRARIES (\w+)\)"
    for loop in re.finditer(r"foreach\(name ([\w/\s]*)\)(.*?)endforeach", text, re.DOTALL):
        if listed := re.search(of_one_file, loop[2]):
            found += [(f"{stem_of(name)}_test", [f"{name}_test.cpp"], listed[1]) for name in loop[1].split()]
    for test in re.finditer(r"ex9000_test\((\w+)\s+SOURCES\s+([\w/.\s]+?)\s+LIBRARIES\s+([\w\s]+?)\)", text):
        found.append((test[1], test[2].split(), test[3]))
    programs = []
    shadows = dict(re.findall(r"target_include_directories\((\w+) BEFORE PRIVATE ([\w/]+)\)", text))
    for name, sources, libraries in found:
        of_process = any(stem_of(source).removesuffix("_test") in PROCESS for source in sources)
        if set(libraries.split()) <= set(LIBRARIES) and not of_process:
            shadow = (f"-I{folder}/{shadows[name]}",) if name in shadows else ()
            programs.append(test_program(name, folder, sources, libraries.split(), shadow))
    return programs


def players():
    """Returns the program that plays the transcripts, and compares random sessions with the reference model."""
    options = ("-O1", f'-DEX9000_CONFORMANCE_DIR="{ROOT}/tests/conformance"')
    reference = files("tests/oracles/reference/*.cpp")
    driver = "tests/oracles/reference/session.cpp"
    units = (
        Unit("players-transcripts", ("tests/conformance/conformance_core_test.cpp",), options),
        Unit("players-sessions", ("tests/firmware/reference_sessions_test.cpp",), options),
        Unit("players-driver", (driver,), options),
        Unit("players-reference", tuple(file for file in reference if file != driver), options),
    )
    # A number of random transactions that is large enough to reach every rule.
    enough = (("EX9000_TRANSACTIONS", "100000"),)
    return Program("transcripts and random sessions", units, LIBRARIES["ex9000_runner"], enough)


# The sources of pico_image_test.
PICO_SOURCES = tuple(f"tests/boards/pico_{part}_test.cpp" for part in ("eeprom", "image", "resets"))
# The images of PICO_TESTS.
PICO_IMAGES = (
    PicoImage("pico", "EX9043D-M"),
    PicoImage("pico", "EX9052D"),
    PicoImage("pico-eeprom", "EX9043D-M", ("-DEX9000_SETTINGS_IN_EEPROM",)),
)
# Tests of PICO_SOURCES that together reach every driver of the area pico.
PICO_TESTS = """
    PicoImage.NoOutputIsEnergisedBeforeTheSettingsAreRead
    PicoImage.TheChipDrivesOnlyTheLineTheStatusLedAndTheOutputsOfTheModel
    PicoImage.OnlyTheFirstCoreRunsAndInterruptsDoNotNest
    PicoImage.TheDriverIsOnForAllBitsOfAReplyAndGoesOffWithinACharacter
    PicoImage.TheModuleRepliesToEveryRequestOfAMasterThatDoesNotPauseAt115200Baud
    PicoImage.AReplyBeginsOneCharacterAfterTheRequest
    PicoImage.AReplyToAStoreBeginsWithoutWaitingForTheTick
    PicoImage.TheModuleCountsEveryPulseOfEightInputsDuringContinuousRequests
    PicoImage.TheModuleReportsTheLevelsOfItsInputs
    PicoImage.TheInitSwitchSelectsTheInitMode
    PicoResets.TheModuleReportsTheReasonOfEachReset
    HangingPicoImage.IsResetByTheWatchdogIfTheMainLoopHangs
    PicoWithEeprom.AReplyToAStoreBeginsWithoutWaitingForThePollOfTheMemory
    PicoWithEeprom.APowerFailureDuringAStoreLeavesTheOldOrTheNewName
    PicoWithEeprom.AnEepromThatBlocksTheBusDoesNotStopTheModule
    PicoWithEeprom.DuringAStartTheModuleFreesABusThatTheEepromHolds
""".split()


def filter_of_pico_tests():
    """Returns the value of GTEST_FILTER that selects PICO_TESTS. A test with parameters runs only with the parameter
    `Nothing`. Exits if one of these tests does not exist, because GoogleTest ignores a name that no test has."""
    source = "".join((ROOT / file).read_text(encoding="utf-8") for file in PICO_SOURCES)
    patterns = []
    for test in PICO_TESTS:
        suite, name = test.split(".")
        if f"({suite}, {name})" not in source:
            sys.exit(f"mutate: PICO_TESTS: {test}: no such test; use a name from {', '.join(PICO_SOURCES)}")
        patterns += [test, f"*/{test}/Nothing"]
    return ":".join(patterns)


# One model with inputs and outputs for each of the two Stellaris boards.
IMAGES = tuple(Image(board, "EX9055D") for board in ("lm3s6965evb", "ek-tm4c123gxl"))


def image_programs():
    programs = []
    for name in ("start_up_driver_test", "image_driver_test"):
        test = Unit(name, (f"tests/boards/{name}.cpp",), ("-O0", SHADOW, '-DEX9000_IMAGES="images"'))
        chosen = (("GTEST_FILTER", "*_EX9055D"),)
        units = (*units_of("line"), "mcu_model")
        programs.append(Program(name, (test,), units, chosen, IMAGES, ("-rdynamic", "-ldl"), 40))
    return programs


def pico_program():
    """Returns the test of the images for the Pico in the emulator."""
    options = ("-O0", '-DEX9000_BUILD_FOLDER="images"', f'-DEX9000_RP2040_EMULATOR="{ROOT}/tests/rp2040/emulator.js"',
               f'-DEX9000_RP2040_MODULES="{ROOT}/build/rp2040js/node_modules"')
    units = tuple(
        Unit(f"pico-{stem_of(file)}", (file,), options)
        for file in (*PICO_SOURCES, "tests/rp2040/emulator_process.cpp", "tests/rp2040/pico_bench.cpp")
    )
    chosen = (("GTEST_FILTER", filter_of_pico_tests()),)
    return Program("pico_image_test", units, LIBRARIES["ex9000_runner"], chosen, PICO_IMAGES, (), 60)


@dataclasses.dataclass(frozen=True)
class Area:
    """The sources to change, the units of the product that contain them, and the tests that must detect a change. Tests
    whose file names begin with the name of the changed file run first. Tests that include the header of this file run
    next. The other tests run last, one group after the other."""

    name: str
    sources: list
    product: list  # units
    groups: list

    def nearest_first(self, file):
        stem = stem_of(file)
        header = f"{file.removesuffix('.cpp').removesuffix('.hpp')}.hpp"

        def distance(program):
            if any(stem_of(source).startswith(stem) for source in program.sources):
                return 0
            if any(header in included(source) for source in program.sources):
                return 1
            return 2

        def reaches(program):
            return any(file in unit.files for unit in program.units)

        return sorted((program for group in self.groups for program in group if reaches(program)), key=distance)


# These tests take too long to run for every mutant.
LONG = {"noise_test", "theory_test"}


def areas():
    firmware = listed_programs("tests/firmware")
    others = {"play", "observed_core"}
    of_core = [each for each in firmware if not others & set(each.libraries) and each.name not in LONG]
    interleaved = [each for each in firmware if each.name == "interleaving_test"]
    hal = listed_programs("tests/hal")
    sim = listed_programs("tests/sim")
    judged = [file for file in files("sim/*.cpp", "sim/*.hpp") if stem_of(file) not in PROCESS]
    core = [LIBRARY_UNITS["core"]]
    images = [image.unit for image in IMAGES]
    of_pico = [image.unit for image in PICO_IMAGES]
    # boot.hpp runs before the image. After a change there, the image does not start, or no test can detect the change.
    of_the_pico = [file for file in files("hal/rp2040/*.hpp") if file != "hal/rp2040/boot.hpp"]
    # Drivers that run only in the emulator are in the area pico, because each of their mutants takes half a minute.
    # A header without code, for example hal/outputs.hpp, only describes a driver.
    drivers = [
        file
        for file in files("hal/*.cpp", "hal/*.hpp")
        if "namespace" in (ROOT / file).read_text(encoding="utf-8")
        if not file.startswith("hal/rp2040/") or any(file in unit.files for each in hal for unit in each.tests)
    ]
    of_drivers = [hal, interleaved, sim, [players()], image_programs()]
    of_simulator = [LIBRARY_UNITS[name] for name in LIBRARIES["ex9000_main"] if name != "core"]
    # In the simulator, only panel_server.cpp includes loopback.hpp, and no unit contains panel_server.cpp. Therefore
    # the units of the test of loopback.hpp count as part of the product.
    of_simulator += [unit for each in sim for unit in each.tests if "sim/front_ends/panel/loopback.hpp" in unit.files]
    return [
        Area("firmware", files("firmware/*.cpp", "firmware/*.hpp"), core + images, [[players()], of_core]),
        Area("hal", drivers, [*core, *images, *of_pico], of_drivers),
        Area("sim", judged, of_simulator, [sim, [players()]]),
        Area("pico", [file for file in of_the_pico if file not in drivers], of_pico, [[pico_program()]]),
    ]
