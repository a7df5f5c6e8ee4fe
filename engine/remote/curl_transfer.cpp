#include "engine/remote/curl_transfer.h"

#include <sys/socket.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "engine/remote/deadlines.h"
#include "engine/remote/local_host.h"

namespace shvr {

namespace {

constexpr size_t MAX_HEADER_BYTES = size_t{64} << 10;
/// The body of an error is read up to this size, since a connection can be reused only if its response was read fully.
constexpr int64_t MAX_ERROR_BYTES = int64_t{16} << 10;

/// Returns the file of certificates that the user has set; null: the system's certificates are used.
const char* certificates()
{
    for (const char* const name : {"CURL_CA_BUNDLE", "AWS_CA_BUNDLE", "SSL_CERT_FILE"})
        if (const char* const value = std::getenv(name); value != nullptr && *value != '\0') return value;
    return nullptr;
}

size_t take_body(char* data, size_t size, size_t count, void* user)
{
    auto& transfer = *static_cast<CurlTransfer*>(user);
    std::vector<std::byte>& body = transfer.response.body;
    const size_t bytes = size * count;
    long status = 0;
    curl_easy_getinfo(transfer.handle, CURLINFO_RESPONSE_CODE, &status);
    const bool is_wanted = status >= 200 && status < 300;
    const auto most = size_t(is_wanted ? transfer.request.max_bytes : MAX_ERROR_BYTES);
    if (bytes > most - std::min(most, body.size())) {
        transfer.response.is_truncated = is_wanted;
        return 0;
    }
    const auto* const from = reinterpret_cast<const std::byte*>(data);
    body.insert(body.end(), from, from + bytes);
    return bytes;
}

/// Parses "bytes 0-9/200".
void take_content_range(std::string_view value, RemoteResponse& response)
{
    if (!value.starts_with("bytes ")) return;
    value.remove_prefix(6);
    response.range_first = whole_of(value.substr(0, value.find('-')));
    const size_t slash = value.find('/');
    if (slash != std::string_view::npos) response.object_bytes = whole_of(value.substr(slash + 1));
}

size_t take_header(char* data, size_t size, size_t count, void* user)
{
    auto& transfer = *static_cast<CurlTransfer*>(user);
    RemoteResponse& response = transfer.response;
    const std::string_view line(data, size * count);
    transfer.header_bytes += line.size();
    if (transfer.header_bytes > MAX_HEADER_BYTES) return 0;
    if (line.starts_with("HTTP/")) {  // new response; the previous one was interim (100, 103) or a proxy's
        response.etag = response.location = response.region = {};
        response.range_first = response.object_bytes = {};
        response.retry_after_s = 0.0;
        return line.size();
    }
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos) return line.size();
    const std::string name = lower_case(line.substr(0, colon));
    const std::string value(trimmed(line.substr(colon + 1)));
    if (name == "etag") response.etag = value;
    if (name == "location") response.location = value;
    if (name == "x-amz-bucket-region") response.region = value;
    if (name == "content-range") take_content_range(value, response);
    if (name == "content-length" && !response.object_bytes && !transfer.request.range)
        response.object_bytes = whole_of(value);
    if (name == "retry-after") response.retry_after_s = double(whole_of(value).value_or(0));
    return line.size();
}

int keep_on(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t)
{
    return static_cast<CurlTransfer*>(user)->is_abandoned ? 1 : 0;
}

curl_socket_t open_socket(void* user, curlsocktype, curl_sockaddr* to)
{
    auto& transfer = *static_cast<CurlTransfer*>(user);
    const bool is_local = is_local_address(to->addr, to->addrlen);
    if (is_local && transfer.request.refuses_local && !transfer.is_proxied) {
        transfer.refused_local = true;
        return CURL_SOCKET_BAD;
    }
    return ::socket(to->family, to->socktype | SOCK_CLOEXEC, to->protocol);
}

bool may_pass(CURLcode code)
{
    switch (code) {
        case CURLE_COULDNT_CONNECT:
        case CURLE_GOT_NOTHING:
        case CURLE_HTTP2:
        case CURLE_HTTP2_STREAM:
        case CURLE_PARTIAL_FILE:
        case CURLE_RECV_ERROR:
        case CURLE_SEND_ERROR:
        case CURLE_SSL_CONNECT_ERROR: return true;
        default: return false;
    }
}

/// Curl's own text. Where it ends with the meaning of its code ("Failed to connect to host port 80 after 0 ms: Couldn't
/// connect to server"), the system's reason takes that place: "Connection refused".
std::string text_of(const CurlTransfer& transfer, CURLcode code)
{
    const std::string meaning = curl_easy_strerror(code);
    std::string text = transfer.error.data();
    if (text.empty()) return meaning;
    const std::string tail = ": " + meaning;
    if (!text.ends_with(tail)) return text;
    text.resize(text.size() - tail.size());
    long reason = 0;
    curl_easy_getinfo(transfer.handle, CURLINFO_OS_ERRNO, &reason);
    return reason == 0 ? text : text + ": " + shvr::reason_of(int(reason));
}

/// Returns the reason of a failure, for the user. Curl's own error text may name a host, but never a query.
std::string reason_of(const CurlTransfer& transfer, CURLcode code)
{
    const Deadlines& limits = deadlines();
    if (transfer.refused_local)
        return "a redirect leads from a public host to an address of this machine or its link; expected a public one";
    if (transfer.response.is_truncated)
        return sentence("the body is longer than ", transfer.request.max_bytes, " bytes; expected at most those");
    if (transfer.header_bytes > MAX_HEADER_BYTES)
        return sentence("the response has more than ", MAX_HEADER_BYTES, " bytes of headers; expected fewer");
    const std::string text = text_of(transfer, code);
    if (code == CURLE_OPERATION_TIMEDOUT)
        return sentence("no answer in time (", text, "); expected a connection within ", limits.connect_s, " s, ",
                        STALL_BYTES_PER_S, " bytes per second over ", limits.stall_s, " s, and an end within ",
                        limits.total_s, " s");
    return text;
}

long milliseconds(double seconds)
{
    return long(seconds * 1000.0);
}

template <class Value>
void set(CURL* handle, CURLoption option, Value value)
{
    const CURLcode code = curl_easy_setopt(handle, option, value);
    SHVR_CHECK(code == CURLE_OK || code == CURLE_OUT_OF_MEMORY, int(option), curl_easy_strerror(code));
    if (code != CURLE_OK) throw std::bad_alloc();
}

void set_limits(CURL* handle, const Deadlines& limits)
{
    set(handle, CURLOPT_NOSIGNAL, 1L);
    set(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    set(handle, CURLOPT_HTTP_VERSION, long(CURL_HTTP_VERSION_2TLS));
    set(handle, CURLOPT_PIPEWAIT, 1L);
    set(handle, CURLOPT_SSLVERSION, long(CURL_SSLVERSION_TLSv1_2));
    set(handle, CURLOPT_FOLLOWLOCATION, 0L);
    set(handle, CURLOPT_PATH_AS_IS, 1L);
    set(handle, CURLOPT_CONNECTTIMEOUT_MS, milliseconds(limits.connect_s));
    set(handle, CURLOPT_TIMEOUT_MS, milliseconds(limits.total_s));
    set(handle, CURLOPT_LOW_SPEED_LIMIT, long(STALL_BYTES_PER_S));
    set(handle, CURLOPT_LOW_SPEED_TIME, std::max(1L, long(limits.stall_s)));
    set(handle, CURLOPT_USERAGENT, "shvr");
    if (const char* const file = certificates()) set(handle, CURLOPT_CAINFO, file);
}

void add_header(CurlTransfer& transfer, const std::string& line)
{
    curl_slist* const longer = curl_slist_append(transfer.headers, line.c_str());
    if (longer == nullptr) throw std::bad_alloc();
    transfer.headers = longer;
}

void set_request(CurlTransfer& transfer)
{
    CURL* const handle = transfer.handle;
    const RemoteRequest& request = transfer.request;
    set(handle, CURLOPT_URL, request.url.c_str());
    if (request.range) {
        const ByteRange& range = *request.range;
        const std::string text =
            range.first < 0 ? sentence("-", range.bytes) : sentence(range.first, "-", range.first + range.bytes - 1);
        set(handle, CURLOPT_RANGE, text.c_str());
    }
    if (!request.unless_etag.empty()) add_header(transfer, "If-None-Match: " + request.unless_etag);
    if (request.keys != nullptr) {
        set(handle, CURLOPT_AWS_SIGV4, ("aws:amz:" + transfer.keys.region + ":s3").c_str());
        set(handle, CURLOPT_USERNAME, transfer.keys.id.c_str());
        set(handle, CURLOPT_PASSWORD, transfer.keys.secret.c_str());
        // The hash of an empty body, which S3 requires and curl 7.88 does not add. Curl signs all headers added here.
        add_header(transfer, "x-amz-content-sha256: e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        if (!transfer.keys.token.empty()) add_header(transfer, "x-amz-security-token: " + transfer.keys.token);
    }
    if (transfer.headers != nullptr) set(handle, CURLOPT_HTTPHEADER, transfer.headers);
    set(handle, CURLOPT_WRITEFUNCTION, take_body);
    set(handle, CURLOPT_WRITEDATA, static_cast<void*>(&transfer));
    set(handle, CURLOPT_HEADERFUNCTION, take_header);
    set(handle, CURLOPT_HEADERDATA, static_cast<void*>(&transfer));
    set(handle, CURLOPT_XFERINFOFUNCTION, keep_on);
    set(handle, CURLOPT_XFERINFODATA, static_cast<void*>(&transfer));
    set(handle, CURLOPT_NOPROGRESS, 0L);
    set(handle, CURLOPT_OPENSOCKETFUNCTION, open_socket);
    set(handle, CURLOPT_OPENSOCKETDATA, static_cast<void*>(&transfer));
    set(handle, CURLOPT_ERRORBUFFER, transfer.error.data());
    set(handle, CURLOPT_PRIVATE, static_cast<void*>(&transfer));
    // An existing connection, opened for another request, was not checked and may lead to a local server.
    if (request.refuses_local) set(handle, CURLOPT_FRESH_CONNECT, 1L);
}

}  // namespace

/// Whether the environment sets a proxy. The address of a connection may then be the proxy's, not the server's.
bool may_use_proxy()
{
    for (const char* const name : {"http_proxy", "https_proxy", "HTTPS_PROXY", "all_proxy", "ALL_PROXY"})
        if (const char* const value = std::getenv(name); value != nullptr && *value != '\0') return true;
    return false;
}

void set_up(CurlTransfer& transfer)
{
    transfer.handle = curl_easy_init();
    if (transfer.handle == nullptr) throw std::bad_alloc();
    set_limits(transfer.handle, deadlines());
    set_request(transfer);
}

void conclude(CurlTransfer& transfer, CURLcode code)
{
    RemoteResponse& response = transfer.response;
    if (transfer.handle == nullptr) {
        response.failure = curl_easy_strerror(code);
        return;
    }
    long status = 0;
    char* address = nullptr;
    curl_easy_getinfo(transfer.handle, CURLINFO_RESPONSE_CODE, &status);
    curl_easy_getinfo(transfer.handle, CURLINFO_PRIMARY_IP, &address);
    // The body of an error may be too long to read; the status alone is sufficient then.
    const bool is_error = code == CURLE_WRITE_ERROR && !response.is_truncated && status >= 300 &&
                          transfer.header_bytes <= MAX_HEADER_BYTES;
    if (code == CURLE_OK || is_error)
        response.status = int(status);
    else
        response.failure = reason_of(transfer, code);
    response.may_pass = may_pass(code);
    response.is_unreached = code == CURLE_COULDNT_RESOLVE_HOST || code == CURLE_COULDNT_RESOLVE_PROXY ||
                            code == CURLE_COULDNT_CONNECT || (code == CURLE_OPERATION_TIMEDOUT && status == 0);
    response.is_from_local = !transfer.is_proxied && address != nullptr && is_local_host(address);
    curl_easy_cleanup(transfer.handle);
    curl_slist_free_all(transfer.headers);
    transfer.handle = nullptr;
    transfer.headers = nullptr;
}

}  // namespace shvr
