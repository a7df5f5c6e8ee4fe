#pragma once
// Addresses of data on other machines: https://host/scan.zarr, http://host:8080/scan.zarr and s3://bucket/key.
//
// A query, as in presigned addresses, is a credential. It is kept in the memory of this process only, and is no part of
// the text that names an address in messages, sessions and lists: take_query removes it where an address enters the
// program. Any thread may call these.

#include <filesystem>
#include <string>
#include <string_view>

namespace shvr {

enum class Scheme { http, https, s3 };

struct Address {
    Scheme scheme = Scheme::https;
    std::string host{};  ///< in lower case, with the port if one is stated; for s3, the bucket
    std::string path{};  ///< percent-encoded, begins with a slash unless empty, has none at its end

    bool operator==(const Address&) const = default;
};

/// The form of a path that may be the address of a volume, as documentation of keys states it (About::allowed). Paths
/// of all other forms are refused if they are addresses.
inline constexpr const char* PATH_OR_ADDRESS = "path or address";

/// Whether `text` is a URL rather than a file path, as in https://host/scan.zarr or s3://bucket/scan.zarr.
bool is_address(std::string_view text);

/// Parses an address. Fails for other schemes, for a name and a password before the host, for queries and fragments,
/// and for "." and ".." in the path. In http and https addresses, "%20" is a space, and characters that a URL may not
/// contain are encoded; an s3 key is taken literally. `text` names the address in messages.
Address parse_address(const std::string& text);

/// Removes the query of an http or https address, and remembers it in this process for requests to that address and
/// below it. Other texts are returned unchanged.
std::string take_query(const std::string& text);
/// Returns the remembered query for an address or one above it; empty if there is none.
std::string query_for(const Address& address);

/// Whether a path is an address, rather than a file or a folder here that is named like one.
bool leads_to_network(const std::filesystem::path& path);
/// The path as it is to be kept: an address unchanged, any other path absolute and normal.
std::filesystem::path whole_path(const std::filesystem::path& path);

/// The host and path of an address, as in "https://host/path".
std::string url_of(const Address& address);
/// Percent-encodes everything except letters, digits, "-._~" and "/".
std::string encoded_key(std::string_view key);

}  // namespace shvr
