#pragma once
// Building blocks of self-contained HTML pages: escaped text, and pictures inside the page. Any thread.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "engine/base/image.h"

namespace shvr::report {

/// Escapes text for use between tags and in attributes, in either kind of quotes. Control characters become "?".
std::string escaped(std::string_view text);
/// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);
/// Returns a picture as a data URL, for an `src` attribute.
std::string source_of(const Image8& image);
/// Returns a whole page: a head with `title`, the CSS of all pages (light or dark, as in the reader's system) and
/// `style`; then `body`, which is markup. Colours are CSS variables: --ink, --faint, --line, --field, --good, --bad.
std::string page(std::string_view title, std::string_view style, std::string_view body);
/// Creates a folder and any missing parents. Fails with a one-sentence message.
void make_folder(const std::filesystem::path& path);
/// Fails as write_file_atomically does.
void write_text(const std::filesystem::path& path, std::string_view text);

}  // namespace shvr::report
