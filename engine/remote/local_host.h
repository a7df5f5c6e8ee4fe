#pragma once
// Addresses of this machine and of its local link. A redirect from a public host must not lead to them. Any thread.

#include <string>

struct sockaddr;

namespace shvr {

/// Whether a numeric IP address, or the host of a URL, is certainly a loopback, link-local or unspecified address.
bool is_local_host(std::string host);
/// Like is_local_host, for a socket address of `bytes` bytes.
bool is_local_address(const sockaddr& address, size_t bytes);

}  // namespace shvr
