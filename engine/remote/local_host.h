#pragma once
// Addresses of this machine and its link, to which a redirect from a public host must not lead. Any thread.

#include <string>

struct sockaddr;

namespace shvr {

/// Whether an IP address in digits, or a host of a URL, is certainly a loopback, link-local or unspecified address.
bool is_local_host(std::string host);
/// Likewise for the address of a socket of `bytes` bytes.
bool is_local_address(const sockaddr& address, size_t bytes);

}  // namespace shvr
