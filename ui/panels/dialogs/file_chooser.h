#pragma once
// A dialog that asks for a file or a folder of this machine: places, a list, and a field for a typed path. If a scan is
// asked for, the field also takes the address of a volume. A refused path stays in the field, with the reason below.
// The file system is asked in the background (asked.h): fast answers appear at once, and during slow answers the dialog
// states that it is waiting. Between Window::begin_ui and Window::present, main thread.

#include <optional>
#include <string>

#include "engine/workbench/actions/action.h"
#include "engine/workbench/models/model.h"
#include "ui/files/asked.h"
#include "ui/files/file_list.h"
#include "ui/panels/field_keys.h"

namespace shvr::ui {

class FileChooser {
public:
    using Wanted = ui::Wanted;
    struct Question {
        const char* title = "";
        const char* verb = "Open";
        std::string note{};  ///< below the list
        Wanted wanted = Wanted::scan;
    };

    explicit FileChooser(const Question& question) : question_(question), all_files_(question.wanted == Wanted::file) {}
    /// Shows the dialog from the next `draw` on. `begin`: path to begin with; empty: the last path, or home.
    void ask(const std::filesystem::path& begin, std::vector<Place> places);
    /// Shows the dialog again, with the reason why the chosen path was refused.
    void ask_again(const std::filesystem::path& path, std::vector<Place> places, std::string failure);
    bool is_open() const { return is_open_ || is_asked_for_; }
    void close() { closes_ = true; }
    /// Draws the dialog, always in the same window. Returns an accepted path, once.
    std::optional<std::filesystem::path> draw();
    /// Returns whether any chooser is shown: then keys go to the chooser.
    static bool has_keys();
    /// Returns whether any chooser is still reading a folder, so that another frame is needed.
    static bool is_busy();

private:
    std::optional<std::filesystem::path> contents();
    void take_answers();
    void note_line(const std::string& failure);
    void filter_row();
    void enter(const std::filesystem::path& folder);
    void select(size_t row);
    void suggest_only_file();
    void path_field();
    void follow_typed();
    void follow(const std::filesystem::path& folder);
    void settle(std::chrono::milliseconds patience = {});
    void forget_questions();
    std::string waits_in_words();
    void place_list();
    void file_table(float height);
    void keys();
    void accept(const std::string& typed, bool enters_folders);
    void accept_address(const std::string& typed);

    Question question_;
    FileList list_;
    std::vector<Place> places_;
    std::string text_;     ///< text of the path field
    std::string failure_;  ///< why the path was refused
    std::optional<size_t> selected_;
    std::string wanted_name_;  ///< name to select as soon as the list contains it
    std::optional<std::filesystem::path> accepted_;
    Asked<Verdict> verdict_;  ///< verdict on `judged_`
    std::filesystem::path judged_;
    Asked<bool> is_folder_;  ///< whether `followed_`, the path to open, is a folder, which the chooser enters
    std::filesystem::path followed_;
    std::optional<double> waiting_since_;  ///< start of the wait, by Dear ImGui's clock
    bool all_files_ = false;
    bool hidden_ = false;
    bool is_asked_for_ = false, is_open_ = false, closes_ = false;
    FieldKeys field_keys_;
    bool field_wants_keys_ = false, field_has_keys_ = false, scrolls_ = false;
    int field_number_ = 0;  ///< incremented to give the field a new id, so that Dear ImGui drops its edit state
};

/// Asks while the model shows the dialog, which ends with the chooser. `begin`: as for FileChooser::ask. Returns the
/// path that was accepted, once.
std::optional<std::filesystem::path> answer_of(FileChooser& chooser, Dialog dialog, const std::filesystem::path& begin,
                                               const Model& model, Actions& actions);

}  // namespace shvr::ui
