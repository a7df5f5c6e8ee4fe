#pragma once
// One request carried out by libcurl; only for curl_transport.cpp.

#include <curl/curl.h>

#include <array>
#include <atomic>
#include <string>

#include "engine/remote/transport.h"

namespace shvr {

/// A request. The requesting thread waits for it, and the thread of the transport carries it out.
struct CurlTransfer {
    RemoteRequest request{};
    SigningKeys keys{};  ///< a copy, since the requesting thread may stop waiting
    RemoteResponse response{};
    std::atomic<bool> is_abandoned = false;
    bool is_done = false;  ///< guarded by the mutex of the transport

    // Members below are used only by the thread of the transport.
    CURL* handle = nullptr;
    curl_slist* headers = nullptr;
    size_t header_bytes = 0;
    bool refused_local = false;
    bool is_proxied = false;  ///< whether the connection's address may be that of a proxy
    std::array<char, CURL_ERROR_SIZE> error{};
};

/// Makes the handle of a transfer. Throws std::bad_alloc if memory is exhausted.
void set_up(CurlTransfer& transfer);
/// Fills in the response after the transfer has ended with `code`, and frees the handle.
void conclude(CurlTransfer& transfer, CURLcode code);

/// Whether the environment names a proxy.
bool may_use_proxy();

}  // namespace shvr
