#pragma once
// Addresses of data on other machines: https://host/scan.zarr, http://host:8080/scan.zarr and s3://bucket/key.
//
// The query of a presigned address is a credential. `take_query` removes it from an address as soon as the program gets
// the address, and keeps it in the memory of this process only. So messages, sessions and lists never contain a query.
// Any thread may call these.

#include <filesystem>
#include <string>
#include <string_view>

namespace shvr {

enum class Scheme { http, https, s3 };

struct Address {
    Scheme scheme = Scheme::https;
    std::string host{};  ///< in lower case, with the port if one is stated; for s3, the bucket
    std::string path{};  ///< percent-encoded; empty, or with a slash at its start and none at its end

    bool operator==(const Address&) const = default;
};

/// The value of About::allowed, in documentation of keys, for a path that may also be the address of a volume. All
/// other path keys refuse addresses.
inline constexpr const char* PATH_OR_ADDRESS = "path or address";

/// Whether `text` is a URL rather than a file path, as in https://host/scan.zarr or s3://bucket/scan.zarr.
bool is_address(std::string_view text);

/// Parses an address. Fails for other schemes, for a user name and password, for queries and fragments, and for "." and
/// ".." in the path. In http and https addresses, "%20" is a space, and characters that a URL may not contain are
/// encoded; an s3 key is taken literally. Messages name the address by `text`.
Address parse_address(const std::string& text);

/// Removes the query of an http or https address, and remembers it in this process for requests to that address and to
/// paths below it. Returns other texts unchanged.
std::string take_query(const std::string& text);
/// Returns the text of an address up to its query or fragment, which is forgotten; other texts unchanged.
std::string url_without_query(const std::string& text);
/// Returns the query remembered for an address or for a path above it; empty if there is none.
std::string query_for(const Address& address);

/// Whether a path is an address, and not a local file or folder whose name looks like one.
bool leads_to_network(const std::filesystem::path& path);
/// Returns the path in the form in which it is stored: an address unchanged, any other path absolute and normalised.
std::filesystem::path whole_path(const std::filesystem::path& path);

/// Returns the host and path of an address, as in "https://host/path".
std::string url_of(const Address& address);
/// Percent-encodes everything except letters, digits, "-._~" and "/".
std::string encoded_key(std::string_view key);

}  // namespace shvr
