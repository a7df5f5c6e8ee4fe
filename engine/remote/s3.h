#pragma once
// Finds the address of a bucket's objects, and the keys that sign requests, from the environment and ~/.aws, like the
// AWS tools.
//
// Reads AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, AWS_SESSION_TOKEN, AWS_PROFILE, AWS_REGION, AWS_DEFAULT_REGION,
// AWS_ENDPOINT_URL_S3, AWS_ENDPOINT_URL, AWS_NO_SIGN_REQUEST, AWS_SHARED_CREDENTIALS_FILE and AWS_CONFIG_FILE. Without
// keys, requests are anonymous. Any thread may call this.

#include <optional>
#include <string>

#include "engine/remote/address.h"
#include "engine/remote/transport.h"

namespace shvr {

struct S3Place {
    std::string url{};  ///< the address, over http or https
    std::optional<SigningKeys> keys{};
    std::string region{};
};

/// Fails if a file of ~/.aws is damaged, or if the profile's keys come from a role, an instance or SSO, which are not
/// supported.
S3Place s3_place(const Address& address);

}  // namespace shvr
