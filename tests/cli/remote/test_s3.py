"""OME-Zarr in S3: a server that recomputes each signature (AWS Signature Version 4, from its specification), where keys,
region and endpoint come from, and what is refused."""
import hashlib
import hmac
import sys
import unittest
from pathlib import Path
from urllib.parse import unquote

sys.path.insert(0, str(Path(__file__).resolve().parent))
import store_server as faults  # noqa: E402
from harness import ENVIRONMENT, run  # noqa: E402
from test_remote import SIZE, RemoteTest  # noqa: E402

KEY, SECRET, TOKEN = "AKIDEXAMPLE", "wJalrXUtn/FEMI+K7MDENG=bPxRfiCYEXAMPLEKEY", "Token/With+Signs=="
EMPTY = hashlib.sha256(b"").hexdigest()
UNRESERVED = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/"


def encoded(path):
    """Percent-encoding as the specification of the signature wants it."""
    return "".join(chr(byte) if byte in UNRESERVED else f"%{byte:02X}" for byte in path.encode())


def is_signed(path, headers, region="us-east-1", token=None):
    """Whether the request carries the signature that the key's owner would compute."""
    form = headers.get("Authorization", "")
    if not form.startswith("AWS4-HMAC-SHA256 "):
        return False
    fields = dict(field.strip().split("=", 1) for field in form.split(" ", 1)[1].split(","))
    names = fields["SignedHeaders"].split(";")
    needed = {"host", "x-amz-date", "x-amz-content-sha256"} | ({"x-amz-security-token"} if token else set())
    if not needed <= set(names) or headers["x-amz-content-sha256"] != EMPTY:
        return False
    if token and headers.get("x-amz-security-token") != token:
        return False
    date = headers["x-amz-date"]
    scope = f"{date[:8]}/{region}/s3/aws4_request"
    if fields["Credential"] != f"{KEY}/{scope}":
        return False
    lines = "".join(f"{name}:{' '.join(headers[name].split())}\n" for name in names)
    canonical = "\n".join(["GET", encoded(unquote(path)), "", lines, fields["SignedHeaders"], EMPTY])
    text = "\n".join(["AWS4-HMAC-SHA256", date, scope, hashlib.sha256(canonical.encode()).hexdigest()])
    key = ("AWS4" + SECRET).encode()
    for part in (date[:8], region, "s3", "aws4_request"):
        key = hmac.new(key, part.encode(), hashlib.sha256).digest()
    return hmac.compare_digest(hmac.new(key, text.encode(), hashlib.sha256).hexdigest(), fields["Signature"])


class S3(RemoteTest):
    def setUp(self):
        super().setUp()
        self.environment = {name: value for name, value in ENVIRONMENT.items() if not name.startswith("AWS_")}
        (self.folder / "home" / ".aws").mkdir(parents=True)

    def keys(self, server, **more):
        return {"HOME": str(self.folder / "home"), "AWS_ENDPOINT_URL": server.address(), "AWS_ACCESS_KEY_ID": KEY,
                "AWS_SECRET_ACCESS_KEY": SECRET, **more}

    def info(self, environment, address="s3://bucket/a=b+c d/x.zarr"):
        return run("info", address, "--json", environment=environment)

    def store(self, *options):
        self.make(*options)
        (self.folder / "served" / "bucket" / "a=b+c d").mkdir(parents=True)
        (self.folder / "served" / "x.zarr").rename(self.folder / "served" / "bucket" / "a=b+c d" / "x.zarr")
        return self.serve()

    # Kind (Servers): signed requests for keys with "=", "+" and spaces, whole and by ranges, with and without a token
    def test_signed_requests(self):
        server = self.store("--ome-zarr", "0.5", "--shards")
        server.check = is_signed
        for more, check in (({}, is_signed),
                            ({"AWS_SESSION_TOKEN": TOKEN}, lambda p, h: is_signed(p, h, token=TOKEN)),
                            ({"AWS_REGION": "eu-west-3"}, lambda p, h: is_signed(p, h, region="eu-west-3"))):
            server.check = check
            result = self.info(self.keys(server, **more))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(str(SIZE[0]), result.stdout)
        self.assertTrue(any("Range" in headers for _, headers in server.requests))
        wrong = self.info(self.keys(server, AWS_SECRET_ACCESS_KEY="wrong"))
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("expected keys that may read it", wrong.stderr)
        for path, headers in server.requests:
            self.assertNotIn(SECRET, path + str(headers))

    def test_keys_of_a_profile_and_none(self):
        server = self.store()
        files = self.folder / "home" / ".aws"
        (files / "credentials").write_text(f"[default]\naws_access_key_id = no\naws_secret_access_key = no\n"
                                           f"[lab]\naws_access_key_id={KEY}\naws_secret_access_key = {SECRET}\n")
        (files / "config").write_text(f"# of the lab\n[profile lab]\nregion = eu-west-3\nendpoint_url = {server.address()}\n"
                                      "s3 =\n  addressing_style = path\n")
        home = {"HOME": str(self.folder / "home")}
        server.check = lambda p, h: is_signed(p, h, region="eu-west-3")
        result = self.info({**home, "AWS_PROFILE": "lab"})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("AWS_PROFILE", self.info({**home, "AWS_PROFILE": "other"}).stderr)
        server.check = lambda _, headers: "Authorization" not in headers
        anonymous = self.info({**home, "AWS_ENDPOINT_URL_S3": server.address(), "AWS_NO_SIGN_REQUEST": "YES"})
        self.assertEqual(anonymous.returncode, 0, anonymous.stderr)
        (files / "credentials").unlink()
        server.check = lambda *_: False
        self.assertIn("of which none were found", self.info({**home, "AWS_ENDPOINT_URL": server.address()}).stderr)

    def test_keys_that_a_service_would_issue(self):
        home = {"HOME": str(self.folder / "home"), "AWS_ENDPOINT_URL": "http://127.0.0.1:9/"}
        for line in ("sso_session = x", "role_arn = arn:aws:iam::1:role/x", "credential_process = /bin/x"):
            (self.folder / "home/.aws/config").write_text(f"[default]\n{line}\n")
            result = self.info(home)
            self.assertEqual(result.returncode, 1)
            self.assertIn(line.split()[0], result.stderr)
            self.assertIn("export-credentials", result.stderr)
        (self.folder / "home/.aws/config").unlink()
        result = self.info({**home, "AWS_WEB_IDENTITY_TOKEN_FILE": "/x"})
        self.assertIn("AWS_WEB_IDENTITY_TOKEN_FILE", result.stderr)
        self.assertIn("AWS_SECRET_ACCESS_KEY", self.info({**home, "AWS_ACCESS_KEY_ID": "x"}).stderr)

    def test_other_regions_and_hosts(self):
        server = self.store()
        server.fault = lambda *_: faults.status(301, x_amz_bucket_region="ap-south-1", Location="http://127.0.0.1:9/x")
        result = self.info(self.keys(server))
        self.assertEqual(result.returncode, 1)
        self.assertIn("is in another region, ap-south-1", result.stderr)
        self.assertNotIn("Secret", result.stderr)


if __name__ == "__main__":
    unittest.main()
