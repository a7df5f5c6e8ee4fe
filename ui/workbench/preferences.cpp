#include "ui/workbench/preferences.h"

#include <algorithm>
#include <cstdlib>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/json.h"
#include "engine/base/text.h"
#include "engine/session/fields.h"

namespace shvr::ui {

namespace {

constexpr int64_t MAX_BYTES = int64_t{1} << 20;

void key_fields(Fields& f, Keymap::Changes& keys)
{
    std::vector<std::string> ids;
    for (const auto& [id, chords] : keys) ids.push_back(id);
    const auto visit = [&](Fields& entry, const std::string& id) {
        std::string text;
        for (const std::string& chord : keys[id]) text += (text.empty() ? "" : " ") + chord;
        entry.text("keys", text, {});
        keys[id].clear();
        for (const std::string_view chord : words_of(text)) keys[id].emplace_back(chord);
    };
    f.entries("keys", ids, "ID", visit, {});
}

struct RecentFile {
    std::filesystem::path path;
};
void fields(Fields& f, RecentFile& recent)
{
    f.path("path", recent.path, {.is_required = true});
}

void fields(Fields& f, Preferences& preferences)
{
    int64_t version = 1;
    f.whole("shvr_preferences", version, 1, 1, {.is_required = true});
    f.choice("key_set", preferences.key_set, {});
    key_fields(f, preferences.keys);
    std::vector<RecentFile> recent;
    for (const std::filesystem::path& path : preferences.recent) recent.push_back({path});
    f.list("recent", recent, Preferences::MAX_RECENT, {});
    preferences.recent.clear();
    for (RecentFile& each : recent) preferences.recent.push_back(std::move(each.path));
    f.checked([&] { static_cast<void>(Keymap(preferences.key_set, preferences.keys)); });
}

std::filesystem::path folder_from(const char* variable)
{
    const char* const value = std::getenv(variable);
    return value && *value == '/' ? std::filesystem::path(value) : std::filesystem::path();
}

}  // namespace

void Preferences::note_opened(const std::filesystem::path& path)
{
    const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
    std::erase(recent, whole);
    recent.insert(recent.begin(), whole);
    recent.resize(std::min(recent.size(), MAX_RECENT));
}

std::filesystem::path preferences_file()
{
    std::filesystem::path folder = folder_from("XDG_CONFIG_HOME");
    if (folder.empty()) {
        folder = folder_from("HOME");
        if (folder.empty()) return {};
        folder /= ".config";
    }
    return folder / "shvr" / "preferences.json";
}

Preferences load_preferences(const std::filesystem::path& file)
{
    Preferences preferences;
    std::error_code ignored;
    if (file.empty() || !std::filesystem::exists(file, ignored)) return preferences;
    const JsonDocument document = read_json(file, MAX_BYTES, {.depth = 8, .expected = "preferences"});
    read_fields(document.root(), file.parent_path(), [&](Fields& f) { fields(f, preferences); });
    return preferences;
}

void save_preferences(const std::filesystem::path& file, const Preferences& preferences)
{
    Preferences written = preferences;  // fields take what they may change
    const std::string text = write_fields(file.parent_path(), [&](Fields& f) { fields(f, written); }) + "\n";
    std::error_code error;
    std::filesystem::create_directories(file.parent_path(), error);
    if (error) fail(file.parent_path().string(), ": cannot be made: ", error.message());
    write_file_atomically(file, std::as_bytes(std::span(text)));
}

}  // namespace shvr::ui
