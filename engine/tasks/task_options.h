#pragma once
// Options of tasks as JSON, for scripts and logs: {"mask": "out.tif", "space": "volume"}. Missing options keep their
// defaults; unknown options are refused by name. Any thread.

#include "engine/jobs/progress_reporter.h"
#include "engine/projects/import_volume.h"
#include "engine/session/session_keys.h"
#include "engine/volume/gaps.h"

namespace shvr {

/// How messages refer to an option: by its JSON key ("break_loops"), by its command-line spelling ("--break-loops"), or
/// by its title in dialogs ("Break loops").
enum class OptionNames { keys, command_line, titles };
std::string option_name(OptionNames names, std::string_view key);
/// Returns the title of an option, or of any other key, in dialogs.
std::string option_title(std::string_view key);

/// Reads options. `origin` names the text in messages; relative paths are relative to `folder`.
template <class Task>
Task from_json(std::string_view text, const std::filesystem::path& folder, const std::string& origin)
{
    Task task;
    const JsonDocument document(text, origin, {.depth = 8, .expected = "options, an object"});
    read_fields(document.root(), folder, [&](Fields& f) { fields(f, task); });
    return task;
}

/// Writes all options that have a value, on one line. Paths inside `folder` become relative to it.
template <class Task>
std::string to_json(Task task, const std::filesystem::path& folder)
{
    return write_fields(folder, [&](Fields& f) { fields(f, task); });
}

/// Returns name, meaning, range and default of each option, for documentation and dialogs.
template <class Task>
std::vector<SessionKey> options_of()
{
    Task task;
    return keys_of([&](Fields& f) { fields(f, task); });
}

/// Adds the option "ome_zarr": a version of OME-Zarr, or "automatic".
void version_field(Fields& f, std::optional<OmeZarrVersion>& version, const char* automatic);

/// Adds the option "allow_incomplete": unreadable data is left out, counted and reported, instead of ending the task.
void incomplete_field(Fields& f, bool& allows_incomplete, const char* counts_as);
/// Returns how unreadable data is handled: refused, unless `allows_incomplete`.
Gaps gaps_of(bool allows_incomplete, OptionNames names);

/// Adds the option "threads": number of worker threads, 0 ... 1024; 0: one per core.
void threads_field(Fields& f, int& threads);
void check_threads(int threads, OptionNames names);
/// Adds an option that is an array of non-empty texts. An empty array is not written.
void texts_field(Fields& f, std::string_view name, std::vector<std::string>& texts, const About& about);

}  // namespace shvr
