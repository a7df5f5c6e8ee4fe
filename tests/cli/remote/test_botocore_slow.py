"""Signatures that a second implementation recomputes: botocore, which Amazon's own tools use. Skipped where it is not
installed."""
import datetime
import json
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from harness import run  # noqa: E402
import test_s3  # noqa: E402
from test_s3 import KEY, SECRET, TOKEN  # noqa: E402

try:
    from botocore.auth import S3SigV4Auth
    from botocore.awsrequest import AWSRequest
    from botocore.credentials import Credentials
except ImportError:
    S3SigV4Auth = None

# Of keys: what a signature and a path may spell differently.
NAMES = ["plain", "a=b+c d", "100%", "ä-ö", "(x)!*'", "a~b_c.d", "~tilde", "semi;colon,at@"]


def is_signed(path, headers, region="us-east-1", token=None):
    """Whether botocore, given what was signed of the request, computes the same signature."""
    form = headers.get("Authorization", "")
    if not form.startswith("AWS4-HMAC-SHA256 "):
        return False
    fields = dict(field.strip().split("=", 1) for field in form.split(" ", 1)[1].split(","))
    signed = {name: headers[name] for name in fields["SignedHeaders"].split(";")}
    if token and signed.get("x-amz-security-token") != token:
        return False
    request = AWSRequest(method="GET", url=f"http://{headers['Host']}{path}", headers=signed)
    request.context["timestamp"] = headers["x-amz-date"]
    auth = S3SigV4Auth(Credentials(KEY, SECRET, token), "s3", region)
    text = auth.string_to_sign(request, auth.canonical_request(request))
    return auth.signature(text, request) == fields["Signature"]


def is_new(headers):
    """Whether the request was signed within 15 minutes, as S3 expects."""
    date = datetime.datetime.strptime(headers["x-amz-date"], "%Y%m%dT%H%M%SZ").replace(tzinfo=datetime.timezone.utc)
    return abs(datetime.datetime.now(datetime.timezone.utc) - date) < datetime.timedelta(minutes=15)


@unittest.skipUnless(S3SigV4Auth, "botocore is not installed (Debian: python3-botocore)")
class Botocore(test_s3.S3):
    # The tests of S3 itself are not repeated.
    test_signed_requests = test_keys_of_a_profile_and_none = test_keys_that_a_service_would_issue = None
    test_other_regions_and_hosts = None

    # Kind (Servers): signatures that botocore recomputes, for keys with signs, whole objects, ranges and ETags
    def test_signatures(self):
        self.make("--ome-zarr", "0.5", "--shards")
        bucket = self.folder / "served" / "bucket"
        bucket.mkdir()
        (self.folder / "served" / "x.zarr").rename(bucket / "x.zarr")
        for name in NAMES:
            (bucket / name).mkdir()
            (bucket / name / "x.zarr").symlink_to(bucket / "x.zarr")
        server = self.serve()
        cases = [(name, {}) for name in NAMES]
        cases += [("plain", {"region": "ap-south-1"}), ("plain", {"token": TOKEN})]
        for name, wanted in cases:
            server.check = lambda path, headers, wanted=wanted: is_signed(path, headers, **wanted) and is_new(headers)
            environment = self.keys(server, AWS_REGION=wanted.get("region", "us-east-1"), AWS_SESSION_TOKEN=wanted.get("token", ""))
            # Twice: the second time with ETags.
            for _ in range(2):
                result = run("label", f"s3://bucket/{name}/x.zarr", "--threshold", "900", "--json", environment=environment)
                self.assertEqual(result.returncode, 0, f"{name}: {result.stderr}")
                self.assertGreater(json.loads(result.stdout)["components"], 0)
        self.assertTrue(any("Range" in headers for _, headers in server.requests))
        self.assertTrue(any("If-None-Match" in headers for _, headers in server.requests))

    def test_other_signatures_are_told_from_right_ones(self):
        server = self.store()
        server.check = is_signed
        self.assertEqual(self.info(self.keys(server, AWS_SECRET_ACCESS_KEY="wrong")).returncode, 1)
        self.assertEqual(self.info(self.keys(server)).returncode, 0)


if __name__ == "__main__":
    unittest.main()
