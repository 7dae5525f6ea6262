# SPDX-License-Identifier: Apache-2.0
"""The command `ros2-gateway cert`: a certificate that this machine signs for itself."""

import contextlib
import datetime as dt
import errno
import ipaddress
import logging
import os
import shlex
import socket
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gateway.cli.announcement import own_addresses
from gateway.errors import UsageError, system_reason

if TYPE_CHECKING:
    from cryptography import x509

logger = logging.getLogger(__name__)

VALID_DAYS: Final = 825  # Apple's devices refuse certificates that are valid for longer

_SIGNER: Final = "ros2-gateway"  # how certificates that this machine has signed are named
# This works for every way to install the gateway. The requirement is that of the extra `tls`.
_HOW_TO_GET_IT: Final = (
    "the package cryptography, which makes certificates, is missing:"
    f" run {shlex.quote(sys.executable)} -m pip install 'cryptography>=43'"
)


def own_certificate(folder: Path) -> tuple[Path, Path]:
    """Return the certificate and the key of this machine, and make them if they are missing.

    A certificate that this machine has signed is replaced when it has expired, or when the machine
    has other addresses now. Any other certificate stays as it is.

    Raises:
        UsageError: as `make_certificate`, or a file there is not a certificate.
    """
    cert, key = folder / "cert.pem", folder / "key.pem"
    why = _why_another(cert) if cert.exists() else "there was none"
    if why is not None:
        make_certificate(folder, (), replace=cert.exists())
        logger.warning("signed a new certificate, %s, because %s: browsers ask once", cert, why)
    return cert, key


def _why_another(path: Path) -> str | None:
    """Return why a certificate is not usable, or ``None``."""
    with _cryptography():
        from cryptography import x509
    try:
        certificate = x509.load_pem_x509_certificate(path.read_bytes())
    except ValueError as error:
        raise UsageError(
            f"{path} is not a certificate in PEM: run ros2-gateway cert --replace to make another"
        ) from error
    except OSError as error:
        raise UsageError(f"cannot read {path}, {system_reason(error)}") from error
    if not certificate.issuer.rfc4514_string().startswith(f"CN={_SIGNER}"):
        return None
    if certificate.not_valid_after_utc <= dt.datetime.now(dt.timezone.utc):
        return "the last one has expired"
    names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    known = {str(each) for each in names.get_values_for_type(x509.IPAddress)}
    here = own_addresses()
    return None if not here or known & set(here) else f"this machine is {here[0]} now"


def make_certificate(folder: Path, names: Sequence[str], *, replace: bool = False) -> list[str]:
    """Write ``cert.pem`` and ``key.pem``, and return the names and addresses that they are for.

    These are *names*, and those of this machine.

    Raises:
        UsageError: the package is missing, a file exists, or the folder cannot be written.
    """
    with _cryptography():
        import cryptography  # noqa: F401
    subjects = list(dict.fromkeys([*names, *_own_names(), *_own_addresses()]))
    certificate, key = _signed(subjects)
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        _write_pair(folder / "key.pem", key, folder / "cert.pem", certificate, replace=replace)
    except FileExistsError as error:
        raise UsageError(f"{error.filename} exists: add --replace to make another") from error
    except OSError as error:
        path = error.filename or folder
        raise UsageError(f"cannot write {path}, {system_reason(error)}") from error
    return subjects


@contextlib.contextmanager
def _cryptography() -> Iterator[None]:
    try:
        yield
    except ImportError as error:
        raise UsageError(_HOW_TO_GET_IT) from error


def _signed(subjects: Sequence[str]) -> tuple[bytes, bytes]:
    from cryptography import x509
    from cryptography.hazmat.primitives import hashes, serialization
    from cryptography.hazmat.primitives.asymmetric import ec
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"{_SIGNER} {subjects[0]}"[:64])])
    now = dt.datetime.now(dt.timezone.utc)
    try:
        alternatives = [_alternative(subject) for subject in subjects]
    except ValueError as error:
        raise UsageError(f"--name: {error}") from error
    certificate = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - dt.timedelta(hours=1))  # clocks of headsets differ
        .not_valid_after(now + dt.timedelta(days=VALID_DAYS))
        .add_extension(x509.SubjectAlternativeName(alternatives), critical=False)
        .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
        .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
        .sign(key, hashes.SHA256())
    )
    return (
        certificate.public_bytes(serialization.Encoding.PEM),
        key.private_bytes(
            serialization.Encoding.PEM,
            serialization.PrivateFormat.PKCS8,
            serialization.NoEncryption(),
        ),
    )


def _alternative(subject: str) -> "x509.GeneralName":
    from cryptography import x509

    with contextlib.suppress(ValueError):
        return x509.IPAddress(ipaddress.ip_address(subject))
    if not subject.isascii() or not subject.replace("-", "").replace(".", "").isalnum():
        raise ValueError(f"got {subject!r}, expected a host name or an address")
    return x509.DNSName(subject)


def _own_names() -> list[str]:
    own = socket.gethostname().lower()
    return [own, f"{own}.local", "localhost"]


def _own_addresses() -> list[str]:
    found = own_addresses()
    with contextlib.suppress(OSError):  # a machine whose own name does not resolve
        infos = socket.getaddrinfo(socket.gethostname(), None)
        found += sorted(str(info[4][0]).partition("%")[0] for info in infos)
    return [*found, "127.0.0.1", "::1"]


def _write_pair(
    key_path: Path, key: bytes, cert_path: Path, certificate: bytes, *, replace: bool
) -> None:
    """Write both files. If the disk is full, both stay as they were.

    They begin under other names, because a key that does not fit the certificate is useless.
    """
    new = {
        path.with_name(f".{path.name}.new"): (path, data, mode)
        for path, data, mode in ((key_path, key, 0o600), (cert_path, certificate, 0o644))
    }
    try:
        for path, (final, data, mode) in new.items():
            path.unlink(missing_ok=True)  # of a process that died here
            _write(path, data, mode)
            if final.exists() and not replace:
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(final))
        for path, (final, _, _) in new.items():
            path.replace(final)
    finally:
        for path in new:
            path.unlink(missing_ok=True)


def _write(path: Path, data: bytes, mode: int) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode)
    with os.fdopen(descriptor, "wb") as file:
        file.write(data)
        file.flush()
        os.fsync(descriptor)  # some file systems know only now that there is no room
