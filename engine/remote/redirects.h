#pragma once
// Which redirects are followed: to http or https, but not from https to http, and to no address of this machine or its
// link from a public host. Any thread may call this.

#include <string>

namespace shvr {

struct Redirect {
    std::string url{};           ///< may contain a credential: never printed
    bool refuses_local = false;  ///< the target must not be a loopback or link-local address
};

/// Returns where a response of the server at `from` leads by its header `location`. `is_from_local`: that server is on
/// this machine or its link. Fails if the redirect must not be followed; messages name its host only.
Redirect redirect_of(const std::string& name, const std::string& from, const std::string& location, bool is_from_local);

}  // namespace shvr
