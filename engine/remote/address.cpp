#include "engine/remote/address.h"

#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

constexpr size_t MAX_ADDRESS_BYTES = 4096;
constexpr std::array<std::pair<std::string_view, Scheme>, 3> SCHEMES{
    {{"http", Scheme::http}, {"https", Scheme::https}, {"s3", Scheme::s3}}};

bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

void append_encoded(std::string& text, char c)
{
    constexpr std::string_view DIGITS = "0123456789ABCDEF";
    const auto byte = static_cast<unsigned char>(c);
    text += {'%', DIGITS[byte >> 4], DIGITS[byte & 15]};
}

/// Percent-encodes the characters that a URL's path may not contain. Leaves bytes that are already encoded unchanged.
std::string encoded_path(std::string_view path)
{
    constexpr std::string_view ALLOWED = "-._~!$&'()*+,;=:@/%";  // RFC 3986, section 3.3
    std::string text;
    for (const char c : path) {
        if (is_letter(c) || is_digit(c) || ALLOWED.find(c) != std::string_view::npos)
            text += c;
        else
            append_encoded(text, c);
    }
    return text;
}

bool has_dot_segments(std::string_view path)
{
    while (!path.empty()) {
        const size_t end = std::min(path.size(), path.find('/'));
        if (path.substr(0, end) == "." || path.substr(0, end) == "..") return true;
        path.remove_prefix(std::min(path.size(), end + 1));
    }
    return false;
}

/// Whether `host` is a host name or a numeric address, with or without a port.
bool is_host(std::string_view host)
{
    const bool is_version_6 = host.starts_with('[');
    const size_t end = is_version_6 ? host.find(']') : std::min(host.size(), host.find(':'));
    if (end == std::string_view::npos || end == 0) return false;
    std::string_view name = host.substr(0, end), port = host.substr(end + (is_version_6 ? 1 : 0));
    if (is_version_6) name.remove_prefix(1);
    const bool is_name = !name.empty() && std::ranges::all_of(name, [&](char c) {
        return is_letter(c) || is_digit(c) || c == '-' || c == '.' || (is_version_6 ? c == ':' : c == '_');
    });
    if (!is_name) return false;
    if (port.empty()) return true;
    port.remove_prefix(1);
    const std::optional<int64_t> number = whole_of(port);
    return host[host.size() - port.size() - 1] == ':' && number && *number >= 1 && *number <= 65535;
}

/// The queries of addresses, by address without query. A query is a credential and is never printed or written to disk.
class Queries {
public:
    void keep(const std::string& address, const std::string& query)
    {
        const std::scoped_lock lock(mutex_);
        queries_[address] = query;
    }
    std::string find(std::string address) const
    {
        const std::scoped_lock lock(mutex_);
        for (;;) {
            if (const auto found = queries_.find(address); found != queries_.end()) return found->second;
            const size_t end = address.rfind('/');
            if (end == std::string::npos || end < 8) return {};
            address.resize(end);
        }
    }

private:
    mutable std::mutex mutex_;
    std::map<std::string, std::string> queries_;
};

Queries& queries()
{
    static Queries kept;
    return kept;
}

}  // namespace

bool is_address(std::string_view text)
{
    // RFC 3986: a scheme is a letter, followed by letters, digits, "+", "-" and ".".
    const auto belongs = [](char c) { return is_letter(c) || is_digit(c) || c == '+' || c == '-' || c == '.'; };
    const size_t end = text.find("://");
    return end != std::string_view::npos && end > 0 && is_letter(text.front()) &&
           std::ranges::all_of(text.substr(0, end), belongs);
}

Address parse_address(const std::string& text)
{
    const size_t scheme_end = std::min(text.size(), text.find("://"));
    const std::string scheme = lower_case(std::string_view(text).substr(0, scheme_end));
    const auto* const found =
        std::ranges::find(SCHEMES, std::string_view(scheme), [](const auto& s) { return s.first; });
    if (found == SCHEMES.end())
        fail(text.find('@') == std::string::npos ? text.substr(0, text.find_first_of("?#")) : scheme + "://...",
             ": has the scheme ", in_quotes(scheme), "; expected http, https or s3");
    std::string_view rest = std::string_view(text).substr(scheme_end + 3);
    const size_t host_end = std::min(rest.size(), rest.find_first_of("/?#"));
    const std::string_view host = rest.substr(0, host_end);
    if (host.find('@') != std::string_view::npos)
        fail(scheme, "://...", printable(host.substr(host.rfind('@'))),
             ": has a name or a password before its host; expected an address without them");
    const bool is_s3 = found->second == Scheme::s3;
    const std::string shown = text.substr(0, is_s3 ? text.size() : text.find_first_of("?#"));
    if (text.size() > MAX_ADDRESS_BYTES)
        fail(in_quotes(shown), ": is an address of ", text.size(), " bytes; expected at most ", MAX_ADDRESS_BYTES);
    if (has_controls(text)) fail(printable(shown), ": contains control characters; expected an address without them");
    if (!is_host(host) || (is_s3 && host.find_first_of(":[") != std::string_view::npos))
        fail(shown, ": has no valid ", is_s3 ? "bucket" : "host", "; expected ",
             is_s3 ? "s3://bucket/key" : "http(s)://host[:port]/path");
    rest.remove_prefix(host_end);
    if (!is_s3 && rest.find_first_of("?#") != std::string_view::npos)
        fail(shown, ": has a query or a fragment; expected an address without them");
    while (rest.ends_with('/')) rest.remove_suffix(1);
    if (has_dot_segments(rest)) fail(shown, ": has \".\" or \"..\" in its path; expected a path without them");
    return {.scheme = found->second, .host = lower_case(host), .path = is_s3 ? encoded_key(rest) : encoded_path(rest)};
}

std::string take_query(const std::string& text)
{
    if (!is_address(text)) return text;
    const std::string scheme = lower_case(text.substr(0, text.find("://")));
    const size_t end = text.find_first_of("?#");
    if ((scheme != "http" && scheme != "https") || end == std::string::npos) return text;
    std::string address = text.substr(0, end);
    if (text[end] == '#') return address;
    const std::string query = text.substr(end + 1, text.find('#') - end - 1);
    if (has_controls(query) || query.find(' ') != std::string::npos)
        fail(address, ": has a query with spaces or control characters; expected it as it was issued");
    if (!query.empty()) queries().keep(url_of(parse_address(address)), query);
    return address;
}

std::string url_without_query(const std::string& text)
{
    const std::string scheme = is_address(text) ? lower_case(text.substr(0, text.find("://"))) : std::string();
    return scheme == "http" || scheme == "https" ? text.substr(0, text.find_first_of("?#")) : text;
}

std::string query_for(const Address& address)
{
    return queries().find(url_of(address));
}

bool leads_to_network(const std::filesystem::path& path)
{
    std::error_code ignored;
    return is_address(path.string()) && !std::filesystem::exists(path, ignored);
}

std::filesystem::path whole_path(const std::filesystem::path& path)
{
    return leads_to_network(path) ? path : std::filesystem::absolute(path).lexically_normal();
}

std::string url_of(const Address& address)
{
    const auto* const scheme = std::ranges::find(SCHEMES, address.scheme, [](const auto& s) { return s.second; });
    return std::string(scheme->first) + "://" + address.host + address.path;
}

std::string encoded_key(std::string_view key)
{
    std::string text;
    for (const char c : key) {
        if (is_letter(c) || is_digit(c) || std::string_view("-._~/").find(c) != std::string_view::npos)
            text += c;
        else
            append_encoded(text, c);
    }
    return text;
}

}  // namespace shvr
