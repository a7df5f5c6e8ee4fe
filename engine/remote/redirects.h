#pragma once
// Decides which redirects are followed: those to http or https, but not from https to http, and not from a public host
// to this machine or its local link. Any thread may call this.

#include <string>

namespace shvr {

struct Redirect {
    std::string url{};           ///< may contain a credential: never printed
    bool refuses_local = false;  ///< the target must not be a loopback or link-local address
};

/// Returns the target of a redirect: the header `location` of a response from `from`. `is_from_local`: the server is on
/// this machine or its local link. Fails if the redirect must not be followed; messages name only its host.
Redirect redirect_of(const std::string& name, const std::string& from, const std::string& location, bool is_from_local);

}  // namespace shvr
