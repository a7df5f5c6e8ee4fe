"""OME-Zarr from a server that others wrote: nginx, over HTTP/1.1 and over HTTP/2 with TLS and a certificate authority of
its own, and through a proxy that delays and breaks connections. Skipped where nginx or openssl is not installed."""
import json
import os
import shutil
import socket
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from harness import run  # noqa: E402
from proxy_server import ProxyServer  # noqa: E402
from test_remote import RemoteTest  # noqa: E402

NGINX = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
OPENSSL = shutil.which("openssl")
HOST = "scans.example"   # in the certificate; requests for it go to this machine through the proxy only

CONFIGURATION = """
{user}
daemon off;
pid {folder}/nginx.pid;
error_log {folder}/error.log;
events {{}}
http {{
    log_format told '$status $server_protocol $request_method $uri range="$http_range" etag="$http_if_none_match"';
    access_log {folder}/access.log told;
    client_body_temp_path {folder}/body;
    proxy_temp_path {folder}/proxy;
    fastcgi_temp_path {folder}/fastcgi;
    uwsgi_temp_path {folder}/uwsgi;
    scgi_temp_path {folder}/scgi;
    default_type application/octet-stream;
    root {served};
    server {{ listen 127.0.0.1:{plain}; }}
    server {{
        listen 127.0.0.1:{secure} ssl http2;
        ssl_certificate {folder}/server.pem;
        ssl_certificate_key {folder}/server.key;
    }}
}}
"""


def free_ports(count):
    """Ports of this machine that are free."""
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@unittest.skipUnless(NGINX, "nginx is not installed (Debian: nginx-light)")
@unittest.skipUnless(OPENSSL, "openssl is not installed")
class Nginx(RemoteTest):
    def openssl(self, *arguments):
        subprocess.run([OPENSSL, *map(str, arguments)], check=True, capture_output=True, cwd=self.etc)

    def make_certificates(self):
        """ca.pem, and server.pem signed by it, for localhost, 127.0.0.1 and HOST."""
        self.openssl("req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=SHVR test authority",
                     "-keyout", "ca.key", "-out", "ca.pem")
        self.openssl("req", "-newkey", "rsa:2048", "-nodes", "-subj", f"/CN={HOST}", "-keyout", "server.key", "-out", "asked.pem")
        (self.etc / "names").write_text(f"subjectAltName=DNS:{HOST},IP:127.0.0.1\n")
        self.openssl("x509", "-req", "-in", "asked.pem", "-CA", "ca.pem", "-CAkey", "ca.key", "-CAcreateserial", "-days", "2",
                     "-extfile", "names", "-out", "server.pem")

    def start(self):
        self.etc = self.folder / "nginx"
        self.etc.mkdir()
        self.make_certificates()
        self.plain, self.secure = free_ports(2)
        user = "user root;" if os.geteuid() == 0 else ""   # its workers read the folder of this test
        (self.etc / "nginx.conf").write_text(CONFIGURATION.format(
            user=user, folder=self.etc, served=self.folder / "served", plain=self.plain, secure=self.secure))
        server = subprocess.Popen([NGINX, "-e", self.etc / "error.log", "-c", self.etc / "nginx.conf"], stderr=subprocess.PIPE)
        self.addCleanup(server.stderr.close)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        while True:
            with socket.socket() as each:
                if each.connect_ex(("127.0.0.1", self.secure)) == 0:
                    return
            self.assertIsNone(server.poll(), "nginx has ended")
            time.sleep(0.02)

    def told(self):
        return (self.etc / "access.log").read_text().splitlines()

    def trusting(self, variable="CURL_CA_BUNDLE", **others):
        """The environment with the file of certificates in this variable, and in none of those that go before it."""
        return {"CURL_CA_BUNDLE": "", "AWS_CA_BUNDLE": "", variable: str(self.etc / "ca.pem"), **others}

    def info(self, address, environment=None):
        result = run("info", address, "--json", environment=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def counts(self, path, environment=None):
        result = run("label", path, "--threshold", "900", "--json", environment=environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(result.stdout)
        return [told[key] for key in ("components", "foreground_voxels", "largest_voxels")]

    # Kind (Servers): nginx, with ranges and ETags, and with HTTP/2 and TLS
    def test_ranges_and_etags(self):
        local = self.make("--ome-zarr", "0.5", "--shards")
        self.start()
        address = f"http://127.0.0.1:{self.plain}/x.zarr"
        self.assertEqual(self.counts(address), self.counts(local))
        self.assertTrue(any(line.startswith("206 HTTP/1.1") for line in self.told()), self.told())
        before = len(self.told())
        self.assertEqual(self.counts(address), self.counts(local))
        again = [line for line in self.told()[before:] if "/0/c/" in line]
        self.assertTrue(again and all(line.startswith(("304", "206")) for line in again), again)
        self.assertTrue(any(line.startswith("304") and 'etag="-"' not in line for line in again), again)

    def test_http_2_with_a_certificate_authority(self):
        local = self.make()
        self.start()
        address = f"https://127.0.0.1:{self.secure}/x.zarr"
        self.assertEqual(self.counts(address, self.trusting()), self.counts(local))
        self.assertTrue(all(" HTTP/2.0 " in line for line in self.told()), self.told())
        for variable in ("AWS_CA_BUNDLE", "SSL_CERT_FILE"):
            self.info(address, self.trusting(variable))

    def test_certificates_that_do_not_hold(self):
        self.make()
        self.start()
        refused = run("info", f"https://127.0.0.1:{self.secure}/x.zarr")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("certificate", refused.stderr)
        other = run("info", f"https://localhost:{self.secure}/x.zarr?sig=Secret", environment=self.trusting())
        self.assertEqual(other.returncode, 1)
        self.assertIn("certificate", other.stderr)
        self.assertNotIn("Secret", other.stderr)
        self.assertEqual(self.told(), [])
        plain = run("info", f"https://127.0.0.1:{self.plain}/x.zarr", environment=self.trusting())
        self.assertEqual(plain.returncode, 1)
        self.assertIn("cannot be read", plain.stderr)

    # Kind (Servers): proxies, that tunnel TLS, delay and break connections, and are left out by name
    def test_a_proxy_that_delays_and_breaks(self):
        local = self.make()
        self.start()
        with ProxyServer(delay_s=0.02, breaks_every=5) as proxy:
            address = f"http://127.0.0.1:{self.plain}/x.zarr"
            self.assertEqual(self.counts(address, {"http_proxy": proxy.address(), "no_proxy": "", "NO_PROXY": "", "SHVR_REMOTE_TRIES": "8"}), self.counts(local))
            self.assertGreater(proxy.broken, 0)
            self.assertTrue(all(target.startswith(address) for target in proxy.targets), proxy.targets)
            before = len(proxy.targets)
            self.info(address, {"http_proxy": proxy.address()})   # which the environment of tests leaves out
            self.assertEqual(len(proxy.targets), before)

    def test_a_tunnel_through_a_proxy(self):
        local = self.make()
        self.start()
        # Only the proxy knows where the host is.
        with ProxyServer(hosts={HOST: ("127.0.0.1", self.secure)}) as proxy:
            environment = self.trusting(https_proxy=proxy.address())
            self.assertEqual(self.counts(f"https://{HOST}/x.zarr", environment), self.counts(local))
            self.assertEqual(set(proxy.targets), {f"{HOST}:443"})
        gone = run("info", f"https://{HOST}/x.zarr", environment={**environment, "SHVR_REMOTE_CACHE_MIB": "0"})
        self.assertEqual(gone.returncode, 1)
        self.assertIn("cannot be read", gone.stderr)


if __name__ == "__main__":
    unittest.main()
