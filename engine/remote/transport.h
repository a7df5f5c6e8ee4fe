#pragma once
// One round of HTTP requests: no request is sent twice, and redirects are not followed (remote_folder.h does both). The
// network is behind an interface, so that tests use one without sockets. Any thread may call these.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shvr {

/// Keys for the signature of a request (AWS Signature Version 4).
struct SigningKeys {
    std::string id{}, secret{};
    std::string token{};  ///< of temporary keys; empty: none
    std::string region{};
};

/// Bytes of an object: from `first` on; or, if `first` is negative, its last bytes.
struct ByteRange {
    int64_t first = 0, bytes = 0;
    bool operator==(const ByteRange&) const = default;
};

struct RemoteRequest {
    std::string url{};                  ///< may contain a credential: never printed
    std::optional<ByteRange> range{};   ///< null: the whole object
    std::string unless_etag{};          ///< asks for the body only if the object has another ETag; empty: always
    int64_t max_bytes = 0;              ///< a longer body is refused
    const SigningKeys* keys = nullptr;  ///< null: not signed
    bool refuses_local = false;         ///< does not connect to a loopback or link-local address
};

struct RemoteResponse {
    int status = 0;             ///< of HTTP; 0: there is no usable response, for the reason in `failure`
    std::string failure{};      ///< as in "ends after 10 of 20 bytes"; names no address
    bool may_pass = false;      ///< whether the failure may be temporary
    bool is_truncated = false;  ///< the body is longer than `max_bytes`
    std::vector<std::byte> body{};
    std::string etag{}, location{}, region{};  ///< headers; empty if absent
    std::optional<int64_t> range_first{};      ///< first byte of a partial body, by its Content-Range
    std::optional<int64_t> object_bytes{};     ///< size of the whole object, if stated
    double retry_after_s = 0.0;
    bool is_unreached = false;   ///< no connection to a server was made
    bool is_from_local = false;  ///< the server has a loopback or link-local address
};

class Transport {
public:
    virtual ~Transport() = default;
    /// Sends all requests, in parallel where possible, and waits for the responses, in the order of the requests.
    /// Throws `Stopped` when waits are over (engine/base/waits/waits.h).
    virtual std::vector<RemoteResponse> perform(std::span<const RemoteRequest> requests) const = 0;
};

/// The transport of this process, by libcurl. One thread carries out the requests of all others.
std::shared_ptr<const Transport> network();

}  // namespace shvr
