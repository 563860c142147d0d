"""An authority, and certificates that it signs, made by the command openssl."""
import pathlib
import subprocess
import tempfile

import grpc


def _openssl(*words):
    subprocess.run(["openssl", *map(str, words)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Authority:
    """An authority in `folder`, or in a temporary folder."""

    def __init__(self, folder=None):
        self._folder = None if folder else tempfile.TemporaryDirectory(prefix="octopair_authority_")
        self.folder = folder or pathlib.Path(self._folder.name)
        self._made = 0
        self._new_key("-x509", "-days", 30, "-keyout", self._file("authority.key"), "-out", self.path(),
                      "-subj", "/CN=authority")
        self.server = self.sign("server", "/CN=server", "DNS:localhost,IP:127.0.0.1")

    def path(self):
        """Returns the file with the authority's certificate."""
        return self._file("authority.pem")

    def remove(self):
        """Removes all files."""
        self._folder.cleanup()

    def _file(self, name):
        return self.folder / name

    def _new_key(self, *words):
        _openssl("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", *words)

    def sign(self, name, subject, alternative_names):
        """Makes a certificate. Returns (certificate file, key file)."""
        certificate, key, request = (self._file(f"{name}.{ending}") for ending in ("pem", "key", "csr"))
        self._new_key("-keyout", key, "-out", request, "-subj", subject)
        extensions = self._file(f"{name}.names")
        extensions.write_text(f"subjectAltName={alternative_names}\n" if alternative_names else "", encoding="ascii")
        _openssl("x509", "-req", "-in", request, "-CA", self.path(), "-CAkey", self._file("authority.key"),
                 "-CAcreateserial", "-days", 30, "-extfile", extensions, "-out", certificate)
        key.chmod(0o600)
        return certificate, key

    def server_options(self, require_client_certificates):
        """Returns the options of a server with TLS. It can accept only clients with a certificate."""
        certificate, key = self.server
        options = ["--tls-certificate", certificate, "--tls-key", key]
        return options + (["--tls-client-authority", self.path()] if require_client_certificates else [])

    def credentials(self, subject=None, alternative_names=""):
        """Returns credentials of a client with a new certificate, or without a certificate if `subject` is None."""
        pair = (None, None)
        if subject is not None:
            self._made += 1
            pair = [file.read_bytes() for file in self.sign(f"client{self._made}", subject, alternative_names)]
        return grpc.ssl_channel_credentials(self.path().read_bytes(), pair[1], pair[0])
