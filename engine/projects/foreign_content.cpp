#include "engine/projects/foreign_content.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/zarr/ome_place.h"
#include "engine/formats/zarr/store/zarr_json.h"
#include "engine/formats/zarr/zarr_chunks.h"
#include "engine/projects/levels/import_pyramid.h"
#include "engine/volume/source.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;
using SortedJson = nlohmann::json;

/// The attributes that SHVR writes. For OME-Zarr 0.5, attributes nested under "ome" are compared without this prefix.
const std::set<std::string, std::less<>> OWN_KEYS{
    "version",
    "multiscales",
    "multiscales.version",
    "multiscales.name",
    "multiscales.axes",
    "multiscales.axes.name",
    "multiscales.axes.type",
    "multiscales.axes.unit",
    "multiscales.datasets",
    "multiscales.datasets.path",
    "multiscales.datasets.coordinateTransformations",
    "multiscales.datasets.coordinateTransformations.type",
    "multiscales.datasets.coordinateTransformations.scale",
    "multiscales.datasets.coordinateTransformations.translation",
    "multiscales.type",
    "multiscales.metadata",
    "multiscales.metadata.description",
    "image-label",
    "image-label.version",
    "image-label.colors",
    "image-label.colors.label-value",
    "image-label.colors.rgba",
    "image-label.properties",
    "image-label.properties.label-value",
    "image-label.properties.name",
    "image-label.source",
    "image-label.source.image",
    "shvr",
    "shvr.shvr_mask",
    "shvr.shvr_offsets",
    "shvr.image",
    "shvr.journal",
    "shvr.journal.name",
    "shvr.journal.record",
    "shvr.journal.checksum",
    "shvr.nrrd_header",
    "shvr_placement",
    "shvr_placement.frame",
    "shvr_placement.directions",
    "shvr_placement.origin",
};

constexpr std::array GROUP_KEYS{"attributes", "node_type", "zarr_format"};

bool is_number(std::string_view name)
{
    return !name.empty() && name.size() <= 20 && name.find_first_not_of("0123456789") == std::string_view::npos &&
           (name.size() == 1 || name.front() != '0');
}

bool is_version_folder(const std::string& name)
{
    return name.starts_with("v") && is_number(std::string_view(name).substr(1));
}

/// Whether the file is a temporary one, left by a process that died while writing (engine/base/atomic_writer.h).
bool is_temporary(const std::string& name)
{
    return name.starts_with(".shvr-");
}

/// Returns the attributes stated in a .zattrs or zarr.json. Moves attributes under "ome" up to the top level.
SortedJson merged_attributes(const SortedJson& document, bool is_3)
{
    if (!is_3) return document;
    SortedJson attributes = document.value("attributes", SortedJson::object());
    if (!attributes.is_object()) return attributes;
    SortedJson ome = attributes.value("ome", SortedJson::object());
    if (!ome.is_object()) return attributes;
    attributes.erase("ome");
    attributes.update(ome);
    return attributes;
}

class Look {
public:
    explicit Look(const fs::path& image) : image_(image)
    {
        std::error_code ignored;
        is_3_ = fs::exists(image / "zarr.json", ignored);
    }

    ForeignContent take() { return std::move(found_); }

    void at_attributes(const std::optional<std::string>& expected)
    {
        const std::string name = is_3_ ? "zarr.json" : ".zattrs";
        const std::optional<SortedJson> document = document_at(image_ / name);
        if (!document) return note(name);
        if (is_3_) at_group_keys(*document, name);
        const SortedJson attributes = merged_attributes(*document, is_3_);
        at_keys(attributes, "", name);
        const auto scales = attributes.find("multiscales");
        if (scales != attributes.end() && (!scales->is_array() || scales->size() != 1)) note_key("multiscales", name);
        has_levels_ = attributes.contains("image-label");
        if (expected) at_values(attributes, merged_attributes(SortedJson::parse(*expected), is_3_), "", name);
    }

    /// `inner`: the folder of this version's levels, relative to the image; "" for levels directly in the image.
    void at_folder(const fs::path& inner)
    {
        const fs::path folder = image_ / inner;
        std::error_code ignored;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
            if (is_full()) return;
            const std::string name = entry.path().filename().string();
            const bool is_folder = entry.is_directory(ignored) && !entry.is_symlink(ignored);
            if (is_folder && is_number(name))
                at_level(folder, inner, std::min(std::stoll("0" + name.substr(0, 6)), 64LL), name);
            else if (is_folder && inner.empty() && is_version_folder(name))
                at_folder(name);
            else if (is_folder || !is_group_file(entry, name))
                at_other(entry, inner / name);
        }
    }

private:
    bool is_full() const { return found_.names.size() >= MAX_FOREIGN_NAMES; }
    void note(const std::string& name)
    {
        if (!is_full() && std::ranges::find(found_.names, name) == found_.names.end()) found_.names.push_back(name);
    }
    void note_key(const std::string& key, const std::string& file) { note(sentence(key, " in ", file)); }

    static bool is_file(const fs::directory_entry& entry)
    {
        std::error_code ignored;
        return entry.is_regular_file(ignored) && !entry.is_symlink(ignored);
    }

    bool is_group_file(const fs::directory_entry& entry, const std::string& name) const
    {
        if (!is_file(entry)) return false;
        return is_3_ ? name == "zarr.json" : name == ".zgroup" || name == ".zattrs";
    }

    void at_other(const fs::directory_entry& entry, const fs::path& relative)
    {
        const std::string name = relative.filename().string();
        if (is_file(entry) && is_temporary(name)) return;
        if (is_file(entry) && is_desktop_file(name)) return found_.desktop_files.push_back(relative);
        note(relative.generic_string());
    }

    static std::optional<SortedJson> document_at(const fs::path& file)
    {
        try {
            return read_zarr_json(file, MAX_ZARR_ATTRIBUTE_BYTES).value();
        } catch (const Error&) {
            return std::nullopt;
        }
    }

    void at_group_keys(const SortedJson& document, const std::string& file)
    {
        for (const auto& [key, value] : document.items())
            if (std::ranges::find(GROUP_KEYS, key) == GROUP_KEYS.end()) note_key(key, file);
    }

    void at_keys(const SortedJson& value, const std::string& key, const std::string& file)
    {
        if (value.is_array())
            for (const SortedJson& element : value) at_keys(element, key, file);
        if (!value.is_object()) return;
        for (const auto& [name, member] : value.items()) {
            const std::string path = key.empty() ? name : sentence(key, ".", name);
            if (OWN_KEYS.contains(path))
                at_keys(member, path, file);
            else
                note_key(path, file);
        }
    }

    /// Ignores values that every save changes: the journal's position and, without name exchange, the levels' folder.
    void at_values(const SortedJson& old, const SortedJson& now, const std::string& key, const std::string& file)
    {
        if (key == "shvr") return;
        if (old.is_object() && now.is_object()) {
            for (const auto& [name, member] : old.items()) {
                const std::string path = key.empty() ? name : sentence(key, ".", name);
                if (!OWN_KEYS.contains(path)) continue;
                at_values(member, now.value(name, SortedJson()), path, file);
            }
        } else if (key == "multiscales" && old.is_array() && now.is_array() && old.size() == 1 && now.size() == 1) {
            at_values(old[0], now[0], key, file);
        } else if ((key == "image-label.colors" || key == "image-label.properties") && old.is_array()) {
            // Entries for new groups may have been added since an interrupted save; no entry may be missing.
            const auto is_kept = [&](const SortedJson& entry) { return std::ranges::find(now, entry) != now.end(); };
            if (!std::ranges::all_of(old, is_kept)) note_key(key, file);
        } else if (without_paths(old, key) != without_paths(now, key)) {
            note_key(key, file);
        }
    }

    static SortedJson without_paths(SortedJson value, const std::string& key)
    {
        if (key == "multiscales.datasets" && value.is_array())
            for (SortedJson& dataset : value)
                if (dataset.is_object()) dataset.erase("path");
        return value;
    }

    /// Returns the metadata of a level, or null if these differ from metadata that SHVR writes.
    std::optional<ZarrMetadata> own_metadata(const fs::path& folder, int64_t level) const
    {
        try {
            const ZarrMetadata metadata = read_zarr_metadata(zarr_folder(folder), is_3_ ? 3 : 2);
            const std::optional<SortedJson> found = document_at(folder / metadata.key());
            const SortedJson own = SortedJson::parse(to_text(metadata));
            const auto is_own = [&](const auto& item) { return own.contains(item.key()); };
            const auto items = found->items();
            const auto size_of = [](const ZarrMetadata& of) { return Size3(of.shape[2], of.shape[1], of.shape[0]); };
            if (metadata.shape.size() != 3 || !std::all_of(items.begin(), items.end(), is_own)) return std::nullopt;
            if (is_3_ && found->value("attributes", SortedJson::object()) != SortedJson::object()) return std::nullopt;
            if (level == 0) return metadata;
            const ZarrMetadata first = read_zarr_metadata(zarr_folder(folder.parent_path() / "0"), is_3_ ? 3 : 2);
            const bool is_level = first.shape.size() == 3 && has_levels_ && level < level_count(size_of(first)) &&
                                  size_of(metadata) == size_of_level(size_of(first), int(level));
            return is_level ? std::optional(metadata) : std::nullopt;
        } catch (const std::exception&) {
            return std::nullopt;
        }
    }

    void at_level(const fs::path& image, const fs::path& inner, int64_t level, const std::string& name)
    {
        const fs::path folder = image / name;
        const std::optional<ZarrMetadata> metadata = own_metadata(folder, level);
        if (!metadata) return note((inner / name).generic_string());
        std::error_code ignored;
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, ignored)) {
            if (is_full()) return;
            if (entry.is_directory(ignored) && !entry.is_symlink(ignored)) continue;
            const std::string key = entry.path().lexically_relative(folder).generic_string();
            if (!is_file(entry) || (key != metadata->key() && chunk_numbers(*metadata, key).empty()))
                at_other(entry, inner / name / key);
        }
    }

    const fs::path& image_;
    bool is_3_ = false;
    bool has_levels_ = false;  ///< false for images of numbers, which only have level 0
    ForeignContent found_;
};

}  // namespace

bool is_desktop_file(const fs::path& path)
{
    constexpr std::array<std::string_view, 6> NAMES{".ds_store",   "thumbs.db",  "ehthumbs.db",
                                                    "desktop.ini", ".directory", ".localized"};
    const std::string name = path.filename().string();
    // On non-Apple file systems, macOS stores its own metadata about the file NAME in "._NAME".
    return name.starts_with("._") || std::ranges::find(NAMES, lower_case(name)) != NAMES.end();
}

ForeignContent foreign_content(const fs::path& image, const std::optional<std::string>& attributes)
{
    std::error_code ignored;
    if (!fs::is_directory(image, ignored) || fs::is_empty(image, ignored)) return {};
    Look look(image);
    look.at_attributes(attributes);
    look.at_folder("");
    return look.take();
}

ForeignContent desktop_files_in(const fs::path& image)
{
    ForeignContent content;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(image, ignored))
        if (is_desktop_file(entry.path()) && entry.is_regular_file(ignored))
            content.desktop_files.push_back(entry.path().filename());
    return content;
}

std::string in_words(const std::vector<std::string>& foreign)
{
    std::string words;
    for (const std::string& name : foreign) words += (words.empty() ? "" : ", ") + printable(name);
    return words + (foreign.size() < MAX_FOREIGN_NAMES ? "" : " and more");
}

void expect_no_foreign_content(const fs::path& image)
{
    const std::vector<std::string> foreign = foreign_content(image).names;
    if (foreign.empty()) return;
    fail(image.string(), ": holds ", in_words(foreign),
         " of another program; expected only what SHVR writes, since the folder is replaced as a whole: move the "
         "folder, "
         "or choose a new name");
}

void carry_over(const ForeignContent& content, const fs::path& from, const fs::path& to, const std::string& inner)
{
    for (const fs::path& file : content.desktop_files) {
        std::error_code ignored;
        if (inner.empty() || file.has_parent_path()) fs::copy_file(from / file, to / inner / file, ignored);
    }
}

}  // namespace shvr
