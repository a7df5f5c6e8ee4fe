#include "engine/movie/frame_folder.h"

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/movie/movie.h"
#include "engine/tasks/task_output.h"

namespace shvr {

namespace fs = std::filesystem;

void check_frame_folder(const fs::path& folder, int frames)
{
    std::error_code error;
    if (fs::exists(folder, error) && !fs::is_directory(folder, error))
        fail(folder.string(), ": is a file; expected a folder for frames, or a name that ends in .webm or .mp4");
    check_output_folder(folder);
    if (!fs::is_directory(folder, error)) return;
    collect_temporary_files(folder);
    for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
         entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const std::optional<int> number = number_of_frame_file(name);
        if (!number)
            fail(folder.string(), ": holds ", in_quotes(name),
                 "; expected a new or empty folder, or one with frames of a movie");
        if (*number < 1 || *number > frames || frame_file(*number - 1, frames) != name)
            fail(folder.string(), ": holds ", name, ", which is no frame of a movie of ", counted(frames, "frame"),
                 " and would stay among them; expected another folder");
    }
    if (error) fail(folder.string(), ": cannot be read: ", error.message());
}

FrameFolder::FrameFolder(fs::path path) : path_(std::move(path)), is_new_(false)
{
    std::error_code error;
    is_new_ = fs::create_directories(path_, error);
    if (error) fail(path_.string(), ": cannot be made: ", error.message());
}

FrameFolder::~FrameFolder()
{
    std::error_code ignored;
    if (is_new_ && fs::is_empty(path_, ignored)) fs::remove(path_, ignored);
}

std::string finished_frames(const fs::path& folder, int finished, int frames)
{
    if (finished == 0) return "no frame is finished";
    const std::string first = (folder / frame_file(0, frames)).string();
    if (finished == 1) return first + " is finished";
    return sentence(first, " to ", frame_file(finished - 1, frames), " are finished");
}

}  // namespace shvr
