"""Writes the bill of materials of a release (SPDX 2.3): the third-party code in the images and in the simulator."""

from __future__ import annotations

import datetime
import json
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import quote

_MIT = "MIT"
_GCC_RUNTIME = "GPL-3.0-or-later WITH GCC-exception-3.1"


@dataclass(frozen=True)
class Component:
    """Third-party code that a product contains or links, and the Debian package from which the build takes it."""

    key: str
    name: str
    licence: str
    package: str
    use: str


@dataclass(frozen=True)
class Product:
    key: str
    name: str
    purpose: str  # primaryPackagePurpose
    parts: Mapping[str, str]  # the relationship to each component, by the key of the component
    remark: str


COMPONENTS = (
    Component("Boost", "Boost", "BSL-1.0", "libboost1.74-dev", "headers: Asio, Beast, text algorithms"),
    Component("CLI11", "CLI11", "BSD-3-Clause", "libcli11-dev", "headers: the command line"),
    Component("nlohmann-json", "JSON for Modern C++", _MIT, "nlohmann-json3-dev", "headers: JSON"),
    Component("yaml-cpp", "yaml-cpp", _MIT, "libyaml-cpp-dev", "bus files"),
    Component("libstdcxx", "libstdc++", _GCC_RUNTIME, "libstdc++-12-dev", "the C++ library of the host"),
    Component(
        "libgcc", "libgcc", _GCC_RUNTIME, "libgcc-12-dev",
        "support functions for the code that the host's compiler generates",
    ),
    Component("glibc", "GNU C Library", "LGPL-2.1-or-later", "libc6-dev", "the C library of the host"),
    Component(
        "libstdcxx-arm", "libstdc++ for Arm", _GCC_RUNTIME, "libstdc++-arm-none-eabi-dev",
        "headers only, for example array and string_view; the images are not linked with this library",
    ),
    Component(
        "libgcc-arm", "libgcc for Arm", _GCC_RUNTIME, "gcc-arm-none-eabi",
        "the integer division routines, because a Cortex-M0+ has no division instruction",
    ),
)

_SIMULATOR = {
    **dict.fromkeys(("Boost", "CLI11", "nlohmann-json"), "CONTAINS"),
    **dict.fromkeys(("yaml-cpp", "libstdcxx", "libgcc"), "STATIC_LINK"),
}
PRODUCTS = (
    Product(
        "firmware", "OpenEX9000 firmware images for Stellaris and Tiva boards", "FIRMWARE",
        {"libstdcxx-arm": "CONTAINS"},
        "The images are linked with -nostdlib and with no library.",
    ),
    Product(
        "firmware-rp2040", "OpenEX9000 firmware images for RP2040 boards", "FIRMWARE",
        {"libstdcxx-arm": "CONTAINS", "libgcc-arm": "STATIC_LINK"},
        "The images are linked with -nostdlib. The only library is libgcc, which contains the integer division "
        "routines.",
    ),
    Product(
        "package", "ex9000-sim, Debian package", "APPLICATION", {**_SIMULATOR, "glibc": "DYNAMIC_LINK"},
        "The package depends on the C library of the system.",
    ),
    Product(
        "static", "ex9000-sim, static program and container image", "APPLICATION",
        {**_SIMULATOR, "glibc": "STATIC_LINK"},
        "To link the program with another C library, set the CMake option EX9000_STATIC and build the target "
        "ex9000-sim-static.",
    ),
)


def bill_of_materials(version: str, commit: str, seconds: int, versions: Mapping[str, str]) -> str:
    """Returns the document. `seconds`: the date of the release, in seconds since 1970. `versions`: the version of each
    Debian package."""
    created = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    relationships = []
    for product in PRODUCTS:
        relationships.append(("SPDXRef-DOCUMENT", "DESCRIBES", _id(product.key)))
        relationships += [(_id(product.key), kind, _id(part)) for part, kind in product.parts.items()]
    document = {
        "spdxVersion": "SPDX-2.3",
        "dataLicense": "CC0-1.0",
        "SPDXID": "SPDXRef-DOCUMENT",
        "name": f"OpenEX9000-{version}",
        "documentNamespace": f"https://spdx.org/spdxdocs/openex9000-{version}-{commit}",
        "creationInfo": {"created": created, "creators": ["Tool: toolchain/release"]},
        "packages": [_product(product, version) for product in PRODUCTS]
        + [_component(component, versions[component.package]) for component in COMPONENTS],
        "relationships": [
            {"spdxElementId": one, "relationshipType": kind, "relatedSpdxElement": other}
            for one, kind, other in relationships
        ],
    }
    return json.dumps(document, indent=2) + "\n"


def _id(key: str) -> str:
    return f"SPDXRef-{key}"


def _product(product: Product, version: str) -> dict[str, object]:
    return {
        "SPDXID": _id(product.key),
        "name": product.name,
        "versionInfo": version,
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": _MIT,
        "licenseDeclared": _MIT,
        "copyrightText": "Copyright (c) 2026 The OpenEX9000 authors",
        "primaryPackagePurpose": product.purpose,
        "comment": product.remark,
    }


def _component(component: Component, version: str) -> dict[str, object]:
    locator = f"pkg:deb/debian/{quote(component.package)}@{quote(version)}?distro=debian-12"
    return {
        "SPDXID": _id(component.key),
        "name": component.name,
        "versionInfo": version,
        "supplier": "Organization: Debian",
        "downloadLocation": "NOASSERTION",
        "filesAnalyzed": False,
        "licenseConcluded": component.licence,
        "licenseDeclared": component.licence,
        "copyrightText": "NOASSERTION",
        "primaryPackagePurpose": "LIBRARY",
        "comment": component.use,
        "externalRefs": [
            {"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl", "referenceLocator": locator}
        ],
    }
