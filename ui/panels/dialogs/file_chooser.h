#pragma once
// A dialog that asks for a file or a folder of this machine: places, a list, and a field for a typed path. Why a path
// cannot be taken is said in it, and the path stays. The file system is asked beside the frames (asked.h): what answers
// at once is there at once, and for what does not, the dialog says that it waits. Between Window::begin_ui and
// Window::present, main thread.

#include <optional>
#include <string>

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
        const char* note = "";  ///< below the list
        Wanted wanted = Wanted::scan;
    };

    explicit FileChooser(const Question& question) : question_(question), all_files_(question.wanted == Wanted::file) {}
    /// Shows it from the next `draw` on. `begin`: a path to begin with; empty: where it was left, or home.
    void ask(const std::filesystem::path& begin, std::vector<Place> places);
    /// The same, with why the path could not be taken.
    void ask_again(const std::filesystem::path& path, std::vector<Place> places, std::string failure);
    bool is_open() const { return is_open_ || is_asked_for_; }
    void close() { closes_ = true; }
    /// In the same window each time. Returns the path that was accepted, once.
    std::optional<std::filesystem::path> draw();
    /// One of all choosers is shown: keys are for it.
    static bool has_keys();
    /// One is reading a folder: another frame is wanted.
    static bool is_busy();

private:
    std::optional<std::filesystem::path> contents();
    void enter(const std::filesystem::path& folder);
    void select(size_t row);
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

    Question question_;
    FileList list_;
    std::vector<Place> places_;
    std::string text_;     ///< of the path field
    std::string failure_;  ///< why the path was not taken
    std::optional<size_t> selected_;
    std::string wanted_name_;  ///< to be selected as soon as it is listed
    std::optional<std::filesystem::path> accepted_;
    Asked<Verdict> verdict_;  ///< on `judged_`
    std::filesystem::path judged_;
    Asked<bool> is_folder_;  ///< whether `followed_`, which may be one, is to be listed
    std::filesystem::path followed_;
    std::optional<double> waiting_since_;  ///< of Dear ImGui's clock
    bool all_files_ = false;
    bool hidden_ = false;
    bool is_asked_for_ = false, is_open_ = false, closes_ = false;
    FieldKeys field_keys_;
    bool field_wants_keys_ = false, field_has_keys_ = false, scrolls_ = false;
    int field_number_ = 0;  ///< another field forgets that it was being edited
};

}  // namespace shvr::ui
