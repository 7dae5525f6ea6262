# SPDX-License-Identifier: Apache-2.0
"""Certificates of TLS, and those who sign them."""

import datetime as dt
import ipaddress
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

DAY = dt.timedelta(days=1)


class Authority:
    """A key that signs certificates."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self._key = ec.generate_private_key(ec.SECP256R1())
        self._name = named(name)
        self.cert = self._write(name, self._name, self._key, is_ca=True)

    def sign(self, name: str, *hosts: str, days: int = 2) -> tuple[str, str]:
        """Return the files of a certificate and its key."""
        key = ec.generate_private_key(ec.SECP256R1())
        cert = self._write(name, named(name), key, *hosts, days=days)
        file = Path(cert).with_suffix(".key")
        encoding, none = serialization.Encoding.PEM, serialization.NoEncryption()
        text = key.private_bytes(encoding, serialization.PrivateFormat.PKCS8, none)
        file.touch(mode=0o600)
        file.write_bytes(text)
        return cert, str(file)

    def _write(
        self,
        name: str,
        subject: x509.Name,
        key: ec.EllipticCurvePrivateKey,
        *hosts: str,
        is_ca: bool = False,
        days: int = 2,
    ) -> str:
        now = dt.datetime.now(dt.timezone.utc)
        builder = (
            x509.CertificateBuilder()
            .subject_name(subject)
            .issuer_name(self._name)
            .public_key(key.public_key())
            .serial_number(x509.random_serial_number())
            .not_valid_before(now - 3 * DAY)
            .not_valid_after(now + days * DAY)
            .add_extension(x509.BasicConstraints(ca=is_ca, path_length=None), critical=True)
        )
        if hosts:
            names = [x509.IPAddress(ipaddress.ip_address(each)) for each in hosts]
            builder = builder.add_extension(x509.SubjectAlternativeName(names), critical=False)
        signed = builder.sign(self._key, hashes.SHA256())
        file = self._folder / f"{name}-{signed.serial_number % 10**6}.pem"
        file.write_bytes(signed.public_bytes(serialization.Encoding.PEM))
        return str(file)


def named(name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
