"""The container's files hold what an operator relies on; no engine is needed to see that."""

import re
import shlex
from typing import Any

import pytest
import yaml

from service.settings import Settings
from tests.project.source import ROOT

DOCKER = ROOT / "docker"
SERVICES: dict[str, dict[str, Any]] = yaml.safe_load((DOCKER / "compose.yml").read_text())["services"]
IMAGE = (DOCKER / "Dockerfile").read_text()
GATEWAY = (DOCKER / "gateway.conf").read_text()
OURS = ("gateway", "imu-health")
BASES = [line.split()[1] for line in IMAGE.splitlines() if line.startswith("FROM ")]
PULLED = [service["image"] for service in SERVICES.values() if "image" in service]
IGNORED = (DOCKER / "Dockerfile.dockerignore").read_text().splitlines()
SECRET = re.compile(r"password|secret|token|private_key", re.IGNORECASE)


def last_stage(image: str) -> list[str]:
    """The instructions of the image that is kept, each on one line, without comments."""
    joined = re.sub(r"\\\n\s*", "", re.sub(r"^#.*\n", "", image, flags=re.MULTILINE))
    lines = [line for line in joined.splitlines() if line]
    return lines[max(i for i, line in enumerate(lines) if line.startswith("FROM")) :]


def test_the_image_runs_as_nobody_in_particular_and_says_how_it_is() -> None:
    words = [line.split(maxsplit=1)[0] for line in last_stage(IMAGE)]
    assert [line for line in last_stage(IMAGE) if line.startswith("USER")] == ["USER 10001"]
    assert words.index("USER") < words.index("ENTRYPOINT")
    assert {"HEALTHCHECK", "STOPSIGNAL", "VOLUME"} <= set(words)


@pytest.mark.parametrize("image", sorted({*BASES, *PULLED}))
def test_every_image_is_of_a_named_version(image: str) -> None:
    name, _, tag = image.partition(":")
    assert name
    assert re.match(r"\d", tag), "a tag without a version is another image tomorrow"


def test_what_is_built_and_what_is_kept_rest_on_one_image() -> None:
    assert len(BASES) == 2
    assert len(set(BASES)) == 1


def test_no_secret_is_written_into_the_files() -> None:
    assert not [line for line in IMAGE.splitlines() if SECRET.search(line)]
    given = [value for service in SERVICES.values() for value in service.get("environment", {}).items()]
    written = {name: text for name, text in given if SECRET.search(f"{name} {text}")}
    assert written
    assert all("${" in re.sub(r"\$\{(\w+):-[^}]+\}", "", text) for text in written.values())


def test_nothing_is_sent_to_the_build_but_what_is_named() -> None:
    assert IGNORED[0] == "*"
    assert not [line for line in IGNORED if line.startswith("!") and ("*" in line or line.startswith("!."))]


def test_the_image_holds_the_program_and_nothing_that_built_it() -> None:
    copied = [shlex.split(line)[1:] for line in last_stage(IMAGE) if line.startswith("COPY")]
    assert copied == [
        ["--from=build", "/opt/imu-health", "/opt/imu-health"],
        ["docker/entrypoint.sh", "/entrypoint.sh"],
    ]
    assert not [line for line in last_stage(IMAGE) if "pip" in line or "apt" in line]


def test_the_image_can_do_what_the_service_can_do_elsewhere() -> None:
    """Every extra that the service asks for by name where it is missing is installed, and so the lock has it."""
    sources = [path.read_text("utf-8") for path in (ROOT / "service").rglob("*.py")]
    asked = {name for text in sources for name in re.findall(r"imu-health\[(\w+)\]", text)} - {"dask"}
    (installed,) = re.findall(r"'\.\[([\w,]+)\]'", IMAGE)
    assert asked
    assert asked <= set(installed.split(","))
    make = (ROOT / "Makefile").read_text("utf-8")
    assert all(f"--extra {extra}" in make for extra in installed.split(","))


def test_the_image_is_compiled_when_it_is_built() -> None:
    """It may not write where it runs, so that every process would compile everything anew."""
    assert "--no-compile" not in IMAGE
    assert IMAGE.index("PYTHONDONTWRITEBYTECODE") > IMAGE.rindex("FROM ")


def test_what_the_image_copies_is_sent_to_the_build() -> None:
    sent = {line[1:] for line in IGNORED if line.startswith("!")}
    taken = {name for line in IMAGE.splitlines() if line.startswith("COPY ") for name in line.split()[1:-1]}
    named = {name for name in taken if not name.startswith(("--", "/"))}
    assert named <= sent
    assert all((ROOT / name).exists() for name in named)


def test_only_the_gateway_is_published_and_on_this_machine_only() -> None:
    assert {name: service["ports"] for name, service in SERVICES.items() if "ports" in service} == {
        "gateway": ["127.0.0.1:8000:8080"]
    }


@pytest.mark.parametrize("name", SERVICES)
def test_every_container_has_limits_and_may_gain_no_rights(name: str) -> None:
    service = SERVICES[name]
    assert {"cpus", "memory", "pids"} <= set(service["deploy"]["resources"]["limits"])
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service["restart"] == "unless-stopped"


@pytest.mark.parametrize("name", OURS)
def test_what_faces_the_network_has_no_rights_and_writes_nothing_but_its_data(name: str) -> None:
    service = SERVICES[name]
    assert (service["cap_drop"], service["read_only"]) == (["ALL"], True)
    assert all(volume.endswith((":ro", ":/data")) for volume in service["volumes"])


def test_two_of_the_service_stand_behind_one_address_and_share_what_they_keep() -> None:
    service = SERVICES["imu-health"]
    assert service["deploy"]["replicas"] == 2
    assert "container_name" not in service
    assert service["volumes"] == ["uploads:/data"]
    assert re.search(r"server imu-health:8000 resolve\b", GATEWAY)
    assert re.search(r"proxy_set_header Host \$http_host;", GATEWAY)


def test_the_gateway_s_file_is_whole() -> None:
    lines = [line.strip() for line in GATEWAY.splitlines() if line.strip() and not line.strip().startswith("#")]
    assert GATEWAY.count("{") == GATEWAY.count("}")
    assert [line for line in lines if not line.endswith((";", "{", "}"))] == []


def test_a_stop_leaves_the_service_the_time_that_it_takes() -> None:
    service = SERVICES["imu-health"]
    grace = int(service["stop_grace_period"].removesuffix("s"))
    assert grace > float(service["environment"]["IMU_HEALTH_STOP_SECONDS"]) + 25  # work beside the requests ends too


def test_every_setting_that_is_given_is_one() -> None:
    given = {*SERVICES["imu-health"]["environment"], *re.findall(r"\b(IMU_HEALTH_[A-Z_]+)=", IMAGE)}
    assert given <= {f"IMU_HEALTH_{name.upper()}" for name in Settings.model_fields}
