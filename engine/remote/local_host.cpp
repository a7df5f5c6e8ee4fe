#include "engine/remote/local_host.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "engine/base/text.h"

namespace shvr {

namespace {

bool is_local_v4(uint32_t address)
{
    return address >> 24 == 127 || address >> 24 == 0 || address >> 16 == 0xA9FE;  // 169.254.0.0/16: link-local
}

bool is_local_v6(const in6_addr& address)
{
    if (IN6_IS_ADDR_V4MAPPED(&address)) {
        uint32_t inner = 0;
        std::memcpy(&inner, address.s6_addr + 12, sizeof(inner));
        return is_local_v4(ntohl(inner));
    }
    return IN6_IS_ADDR_LOOPBACK(&address) || IN6_IS_ADDR_LINKLOCAL(&address) || IN6_IS_ADDR_UNSPECIFIED(&address);
}

}  // namespace

bool is_local_host(std::string host)
{
    if (host.starts_with('[')) {
        host.erase(0, 1);
        host.resize(std::min(host.size(), host.find_first_of("]%")));
    } else if (std::ranges::count(host, ':') == 1) {
        host.resize(host.find(':'));
    }
    host = lower_case(host);
    while (host.ends_with('.')) host.pop_back();
    in_addr v4{};
    in6_addr v6{};
    if (::inet_pton(AF_INET, host.c_str(), &v4) == 1) return is_local_v4(ntohl(v4.s_addr));
    if (::inet_pton(AF_INET6, host.substr(0, host.find('%')).c_str(), &v6) == 1) return is_local_v6(v6);
    return host == "localhost" || host.ends_with(".localhost");
}

bool is_local_address(const sockaddr& address, size_t bytes)
{
    if (address.sa_family == AF_INET && bytes >= sizeof(sockaddr_in)) {
        sockaddr_in v4{};
        std::memcpy(&v4, &address, sizeof(v4));
        return is_local_v4(ntohl(v4.sin_addr.s_addr));
    }
    if (address.sa_family != AF_INET6 || bytes < sizeof(sockaddr_in6)) return false;
    sockaddr_in6 v6{};
    std::memcpy(&v6, &address, sizeof(v6));
    return is_local_v6(v6.sin6_addr);
}

}  // namespace shvr
