// JOURNAL.lock, which names the writer of a journal: its text and, if that names a process of another machine, the file
// while it is locked. (For a process of this machine the reader waits for a text that is up to date.)

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>

#include "engine/annotation/writers/holder_text.h"
#include "engine/base/text.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/fuzz/support/input_folder.h"

namespace {

using namespace shvr;
using namespace shvr::fuzz;

constexpr size_t MAX_LOCK_BYTES = 4096;

std::string this_host()
{
    char name[256] = {};
    return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

void check(const Holder& holder)
{
    const std::string words = in_words(holder);
    expect(!words.empty() && !has_controls(words), "a holder that a terminal cannot show");
    expect(words.size() <= 700, "a holder that no message can quote");
    const std::string text = to_text(holder);
    expect(std::ranges::count(text, '\n') == 5, "a holder of more lines than it has parts");
    expect(to_text(parse_holder(text)) == text, "a holder that is not read as it was written");
}

void read_held(std::string_view text)
{
    const InputFolder& folder = input_folder();
    folder.clear();
    const std::filesystem::path journal = folder.path() / "scan.journal";
    const std::filesystem::path path = folder.write("scan.journal.lock", text);
    expect(!holder_of(journal), "a lock that nobody holds");
    const FileDescriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
    struct flock whole {};
    whole.l_type = F_WRLCK;
    whole.l_whence = SEEK_SET;
    expect(::fcntl(file.number(), F_OFD_SETLK, &whole) == 0, "no lock for the test");
    const std::optional<Holder> holder = holder_of(journal);
    expect(holder.has_value(), "a lock whose holder is not seen");
    check(*holder);
    bool is_taken = false;
    try {
        static_cast<void>(Hold::take(journal, "fuzz"));
    } catch (const JournalTaken&) {
        is_taken = true;
    }
    expect(is_taken, "a lock that is taken twice");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    const std::string_view text = text_of({data, size});
    Holder holder;
    accepts([&] { holder = parse_holder(text); });
    check(holder);
    const Holder held = parse_holder(text.substr(0, MAX_LOCK_BYTES));
    if (whole_of(held.process) && held.host != this_host()) read_held(text);
    return 0;
}
