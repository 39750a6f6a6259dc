"""Tests the tar file of the container image. This file must contain an OCI image layout and a manifest for Docker."""

from __future__ import annotations

import hashlib
import io
import json
import tarfile
import unittest

import parts
from container import container_image

PROGRAM = b"a static program"


def contents(archive: bytes) -> dict[str, bytes]:
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        return {member.name: tar.extractfile(member).read() for member in tar if member.isfile()}


class Container(unittest.TestCase):
    def setUp(self) -> None:
        self.archive = container_image(PROGRAM, b"licences", "1.00", "abc", parts.SECONDS)
        self.files = contents(self.archive)

    def blob(self, descriptor: dict[str, object]) -> bytes:
        blob = self.files["blobs/" + str(descriptor["digest"]).replace(":", "/")]
        self.assertEqual(descriptor["size"], len(blob))
        self.assertEqual(descriptor["digest"], "sha256:" + hashlib.sha256(blob).hexdigest())
        return blob

    def test_the_layer_of_the_oci_layout_contains_the_program(self) -> None:
        self.assertEqual(json.loads(self.files["oci-layout"]), {"imageLayoutVersion": "1.0.0"})
        (entry,) = json.loads(self.files["index.json"])["manifests"]
        manifest = json.loads(self.blob(entry))
        config = json.loads(self.blob(manifest["config"]))
        layer = self.blob(manifest["layers"][0])
        self.assertEqual(config["rootfs"]["diff_ids"], [manifest["layers"][0]["digest"]])
        self.assertEqual(config["created"], "2026-09-21T14:13:20Z")
        self.assertEqual(contents(layer)["ex9000-sim"], PROGRAM)

    def test_the_docker_manifest_names_the_same_files_as_the_oci_manifest(self) -> None:
        (docker,) = json.loads(self.files["manifest.json"])
        (entry,) = json.loads(self.files["index.json"])["manifests"]
        manifest = json.loads(self.blob(entry))
        self.assertEqual(docker["RepoTags"], ["ex9000-sim:1.00"])
        for path, descriptor in ((docker["Config"], manifest["config"]), (docker["Layers"][0], manifest["layers"][0])):
            self.assertEqual(path, "blobs/" + descriptor["digest"].replace(":", "/"))

    def test_an_ordinary_user_runs_the_program_in_a_folder_that_this_user_owns(self) -> None:
        manifest = json.loads(self.files["manifest.json"])[0]
        config = json.loads(self.files[manifest["Config"]])["config"]
        self.assertEqual((config["User"], config["Entrypoint"]), ("65534:65534", ["/ex9000-sim"]))
        with tarfile.open(fileobj=io.BytesIO(self.files[manifest["Layers"][0]])) as layer:
            self.assertEqual(layer.getmember("ex9000-sim").mode, 0o755)
            folder = layer.getmember(config["WorkingDir"].strip("/"))
            self.assertEqual((folder.uid, folder.isdir()), (65534, True))

    def test_the_same_input_gives_the_same_bytes(self) -> None:
        self.assertEqual(container_image(PROGRAM, b"licences", "1.00", "abc", parts.SECONDS), self.archive)


if __name__ == "__main__":
    unittest.main()
