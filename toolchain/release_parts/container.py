"""Writes a container image with one static program, its licences, and an empty working directory.

The image is a tar file with an OCI image layout (OCI image specification 1.0). The tar file also contains the file
manifest.json of `docker save`, so both `podman load` and `docker load` accept the tar file.
"""

from __future__ import annotations

import datetime
import hashlib
import io
import json
import tarfile

_USER = 65534  # nobody
_WORKING_DIRECTORY = "data"
_CONFIG_TYPE = "application/vnd.oci.image.config.v1+json"
_LAYER_TYPE = "application/vnd.oci.image.layer.v1.tar"
_MANIFEST_TYPE = "application/vnd.oci.image.manifest.v1+json"


def container_image(program: bytes, licence: bytes, version: str, commit: str, seconds: int) -> bytes:
    """Returns the tar file. `seconds`: the date of the image and of all files, in seconds since 1970."""
    layer = _tar([
        ("ex9000-sim", program, 0o755, 0),
        ("LICENSE", licence, 0o644, 0),
        (f"{_WORKING_DIRECTORY}/", b"", 0o755, _USER),
    ], seconds)
    config = _json(_config(layer, version, commit, seconds))
    manifest = _json({
        "schemaVersion": 2,
        "mediaType": _MANIFEST_TYPE,
        "config": _descriptor(_CONFIG_TYPE, config),
        "layers": [_descriptor(_LAYER_TYPE, layer)],
    })
    name = f"ex9000-sim:{version}"
    index = {
        "schemaVersion": 2,
        "manifests": [
            {
                **_descriptor(_MANIFEST_TYPE, manifest),
                "annotations": {"org.opencontainers.image.ref.name": name},
                "platform": {"architecture": "amd64", "os": "linux"},
            }
        ],
    }
    docker = [{"Config": _path(config), "RepoTags": [name], "Layers": [_path(layer)]}]
    files = {
        "oci-layout": _json({"imageLayoutVersion": "1.0.0"}),
        "index.json": _json(index),
        "manifest.json": _json(docker),
        **{_path(blob): blob for blob in (config, layer, manifest)},
    }
    return _tar([(path, files[path], 0o644, 0) for path in sorted(files)], seconds)


def _config(layer: bytes, version: str, commit: str, seconds: int) -> dict[str, object]:
    created = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {
        "created": created,
        "architecture": "amd64",
        "os": "linux",
        "config": {
            "User": f"{_USER}:{_USER}",
            "Entrypoint": ["/ex9000-sim"],
            "Cmd": ["--help"],
            "WorkingDir": f"/{_WORKING_DIRECTORY}",
            "ExposedPorts": {"5020/tcp": {}},
            "Labels": {
                "org.opencontainers.image.title": "ex9000-sim",
                "org.opencontainers.image.description": "Simulated EX9000 modules on RS-485 lines",
                "org.opencontainers.image.version": version,
                "org.opencontainers.image.revision": commit,
                "org.opencontainers.image.licenses": "MIT",
            },
        },
        "rootfs": {"type": "layers", "diff_ids": [_digest(layer)]},
        "history": [{"created": created, "created_by": f"ex9000-sim {version}"}],
    }


def _tar(entries: list[tuple[str, bytes, int, int]], seconds: int) -> bytes:
    """Returns a tar file. An entry is a path, a content, a mode and an owner. A path that ends in / is a directory."""
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for path, content, mode, owner in entries:
            member = tarfile.TarInfo(path.rstrip("/"))
            member.type = tarfile.DIRTYPE if path.endswith("/") else tarfile.REGTYPE
            member.size, member.mode, member.mtime = len(content), mode, seconds
            member.uid = member.gid = owner
            archive.addfile(member, io.BytesIO(content))
    return file.getvalue()


def _json(value: object) -> bytes:
    return json.dumps(value, sort_keys=True, separators=(",", ":")).encode()


def _digest(blob: bytes) -> str:
    return "sha256:" + hashlib.sha256(blob).hexdigest()


def _path(blob: bytes) -> str:
    return "blobs/" + _digest(blob).replace(":", "/")


def _descriptor(media_type: str, blob: bytes) -> dict[str, object]:
    return {"mediaType": media_type, "digest": _digest(blob), "size": len(blob)}
