#include "engine/formats/zarr/chunk_listing.h"

#include <dirent.h>

#include <cerrno>
#include <charconv>
#include <memory>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {
namespace {

constexpr int64_t MAX_NAMES_LOOKED_AT = 1024;

/// Calls `take(name)` for every entry until it returns false; false if it did. A folder that is missing has none.
template <class Take>
bool for_each_name(const std::filesystem::path& folder, const Take& take)
{
    const auto close = [](DIR* directory) { ::closedir(directory); };
    const std::unique_ptr<DIR, decltype(close)> directory(::opendir(folder.c_str()), close);
    if (!directory) {
        if (errno == ENOENT || errno == ENOTDIR) return true;
        fail(folder.string(), ": its chunks cannot be listed: ", reason_of(errno));
    }
    for (;;) {
        errno = 0;
        const dirent* const entry = ::readdir(directory.get());
        if (entry == nullptr && errno != 0) fail(folder.string(), ": its chunks cannot be listed: ", reason_of(errno));
        if (entry == nullptr) return true;
        if (entry->d_name[0] != '.' && !take(std::string_view(entry->d_name))) return false;
    }
}

/// As programs write it: digits, and no 0 before others.
std::optional<int64_t> number_in(std::string_view text)
{
    int64_t number = 0;
    const auto end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, number);
    const bool is_plain = !text.empty() && text[0] != '-' && text[0] != '+' && (text.size() == 1 || text[0] != '0');
    return is_plain && result.ec == std::errc() && result.ptr == end ? std::optional(number) : std::nullopt;
}

class Listing {
public:
    Listing(const ChunkNames& names, int64_t most, const std::function<void(std::span<const int64_t>)>& take)
        : names_(names), take_(take), numbers_(names.counts.size()), left_(most), names_left_(8 * most + (1 << 16))
    {}

    /// The folder of nested names from `axis` on.
    bool list_nested(const std::filesystem::path& folder, size_t axis)
    {
        const bool is_last = axis + 1 == numbers_.size();
        if (!is_last && names_.at[axis]) {
            numbers_[axis] = *names_.at[axis];
            return list_nested(folder / std::to_string(numbers_[axis]), axis + 1);
        }
        return for_each_name(folder, [&](std::string_view name) {
            if (--names_left_ < 0) return false;
            const std::optional<int64_t> number = number_in(name);
            if (!number || !fits(axis, *number)) return true;
            numbers_[axis] = *number;
            return is_last ? found() : list_nested(folder / name, axis + 1);
        });
    }

    bool list_flat()
    {
        return for_each_name(names_.folder, [&](std::string_view name) {
            if (--names_left_ < 0) return false;
            return !is_chunk(name) || found();
        });
    }

private:
    bool fits(size_t axis, int64_t number) const
    {
        return number < names_.counts[axis] && names_.at[axis].value_or(number) == number;
    }
    bool found()
    {
        if (--left_ < 0) return false;
        take_(numbers_);
        return true;
    }
    bool is_chunk(std::string_view name)
    {
        if (!name.starts_with(names_.prefix)) return false;
        name.remove_prefix(names_.prefix.size());
        for (size_t axis = 0; axis < numbers_.size(); ++axis) {
            const size_t end = axis + 1 == numbers_.size() ? name.size() : name.find(names_.separator);
            if (end == std::string_view::npos) return false;
            const std::optional<int64_t> number = number_in(name.substr(0, end));
            if (!number || !fits(axis, *number)) return false;
            numbers_[axis] = *number;
            name.remove_prefix(std::min(name.size(), end + 1));
        }
        return true;
    }

    const ChunkNames& names_;
    const std::function<void(std::span<const int64_t>)>& take_;
    std::vector<int64_t> numbers_;
    int64_t left_, names_left_;
};

/// The numbers of a name in any form; empty if it is no chunk's.
std::vector<int64_t> numbers_of(std::string_view name, char separator)
{
    std::vector<int64_t> numbers;
    for (;;) {
        const size_t end = std::min(name.size(), name.find(separator));
        const std::optional<int64_t> number = number_in(name.substr(0, end));
        if (!number) return {};
        numbers.push_back(*number);
        if (end == name.size()) return numbers;
        name.remove_prefix(end + 1);
    }
}

}  // namespace

bool list_chunks(const ChunkNames& names, int64_t most, const std::function<void(std::span<const int64_t>)>& take)
{
    Listing listing(names, most, take);
    return names.separator == '/' ? listing.list_nested(names.folder / names.prefix, 0) : listing.list_flat();
}

std::string stray_chunk(const ChunkNames& names)
{
    const bool is_nested = names.separator == '/';
    const size_t numbers_in_name = is_nested ? 1 : names.counts.size();
    std::string stray;
    int64_t left = MAX_NAMES_LOOKED_AT;
    static_cast<void>(for_each_name(is_nested ? names.folder / names.prefix : names.folder, [&](std::string_view name) {
        const bool has_prefix = is_nested || name.starts_with(names.prefix);
        const std::string_view rest = is_nested || !has_prefix ? name : name.substr(names.prefix.size());
        const std::vector<int64_t> numbers = numbers_of(rest, is_nested ? '.' : names.separator);
        // A lone number is a folder of nested chunks, or the chunk of an array of one axis.
        bool is_stray = !numbers.empty() && numbers.size() != numbers_in_name;
        for (size_t axis = 0; !is_stray && axis < numbers.size(); ++axis)
            is_stray = numbers[axis] >= names.counts[axis];
        if (is_stray) stray = name;
        return !is_stray && --left > 0;
    }));
    return stray;
}

}  // namespace shvr
