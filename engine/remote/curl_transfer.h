#pragma once
// One request carried out by libcurl; only for curl_transport.cpp.

#include <curl/curl.h>

#include <array>
#include <atomic>
#include <string>

#include "engine/remote/transport.h"

namespace shvr {

/// A request, shared by the thread that waits for it and the thread of the transport, which carries it out.
struct CurlTransfer {
    RemoteRequest request{};
    SigningKeys keys{};  ///< a copy: the thread that asked may leave
    RemoteResponse response{};
    std::atomic<bool> is_abandoned = false;
    bool is_done = false;  ///< guarded by the mutex of the transport

    // Used by the thread of the transport only.
    CURL* handle = nullptr;
    curl_slist* headers = nullptr;
    size_t header_bytes = 0;
    bool refused_local = false;
    bool is_proxied = false;  ///< the address of the connection may be a proxy's
    std::array<char, CURL_ERROR_SIZE> error{};
};

/// Makes the handle of a transfer. Throws std::bad_alloc if memory is exhausted.
void set_up(CurlTransfer& transfer);
/// Completes the response after the transfer has ended with `code`, and frees the handle.
void conclude(CurlTransfer& transfer, CURLcode code);

/// Whether the environment names a proxy.
bool may_use_proxy();

}  // namespace shvr
