#include "engine/annotation/work/journal_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "engine/annotation/work/journal_head.h"
#include "engine/base/error.h"
#include "engine/projects/foreign_content.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr char MAGIC[] = {'S', 'H', 'V', 'R', 'J', 'R', 'N', 'L'};
constexpr uint32_t VERSION = 1;
constexpr size_t FILE_HEADER_BYTES = 16;
constexpr size_t HEADER_BYTES = RECORD_HEADER_BYTES;
constexpr size_t CHECKSUM_AT = 32;
constexpr uint16_t COMPRESSED = 1;
/// Smaller contents do not become shorter in a zstd frame.
constexpr size_t MIN_COMPRESSED_BYTES = 64;

using Header = std::array<std::byte, HEADER_BYTES>;

void put(std::byte* at, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i) at[i] = std::byte(value >> (8 * i));
}

uint64_t get(const std::byte* at, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= uint64_t(at[i]) << (8 * i);
    return value;
}

class Checksum {
public:
    explicit Checksum(uint64_t seed) : state_(XXH3_createState(), &XXH3_freeState)
    {
        XXH3_64bits_reset_withSeed(state_.get(), seed);
    }
    void add(std::span<const std::byte> bytes) { XXH3_64bits_update(state_.get(), bytes.data(), bytes.size()); }
    uint64_t value() const { return XXH3_64bits_digest(state_.get()); }

private:
    std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

uint64_t checksum_of(uint64_t before, const Header& header, std::span<const std::byte> label_and_content)
{
    Checksum checksum(before);
    checksum.add(std::span(header).first(CHECKSUM_AT));
    checksum.add(label_and_content);
    return checksum.value();
}

/// Returns the number of bytes read, which is smaller at the end of the file. `head`: as in JournalScan.
size_t read_at(const FileDescriptor& file, const fs::path& path, uint64_t at, std::span<std::byte> into,
               std::span<const std::byte> head = {})
{
    size_t done = 0;
    while (done < into.size()) {
        const ssize_t count = ::pread(file.number(), into.data() + done, into.size() - done, off_t(at + done));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
        if (count == 0) break;
        done += size_t(count);
    }
    for (size_t i = 0; i < done && at + i < head.size(); ++i) into[i] = head[at + i];
    return done;
}

bool has_plausible_sizes(const JournalRecord& record)
{
    return record.bytes <= MAX_RECORD_BYTES && (record.is_compressed || record.bytes == record.stored_bytes);
}

/// Returns the fields of a record, except its label and checksum. Sets `label_bytes` to the label's length.
JournalRecord fields_of(const Header& header, uint64_t at, uint64_t& label_bytes)
{
    label_bytes = get(&header[6], 2);
    return {.kind = RecordKind(get(&header[0], 4)),
            .label = {},
            .about = get(&header[24], 8),
            .content_at = at + HEADER_BYTES + label_bytes,
            .stored_bytes = get(&header[8], 8),
            .bytes = get(&header[16], 8),
            .is_compressed = (get(&header[4], 2) & COMPRESSED) != 0};
}

/// Returns false if the file has no header yet: after a power cut, a new journal may contain only part of the header,
/// or none of it, and zeros for the rest. Fails if the file is not a journal.
bool has_file_header(const FileDescriptor& file, const fs::path& path, const JournalScan& scan)
{
    const uint64_t file_bytes = scan.file_bytes;
    std::array<std::byte, FILE_HEADER_BYTES> header{};
    const size_t there = read_at(file, path, 0, header, scan.head);
    const std::vector<std::byte> ours = journal_header();
    bool is_whole = there == FILE_HEADER_BYTES, is_ours_in_part = file_bytes <= FILE_HEADER_BYTES;
    for (size_t i = 0; i < there; ++i) {
        is_whole = is_whole && header[i] == ours[i];
        is_ours_in_part = is_ours_in_part && (header[i] == ours[i] || header[i] == std::byte(0));
    }
    if (is_ours_in_part && !is_whole) return false;
    const size_t compared = std::min(there, sizeof MAGIC);
    if (std::memcmp(header.data(), ours.data(), compared) != 0)
        fail(path.string(), ": does not begin with SHVRJRNL; expected a journal, or no such file: once it has ",
             "another name, the project opens with its saved files");
    const uint64_t version = get(header.data() + sizeof MAGIC, 4);
    if (file_bytes >= FILE_HEADER_BYTES && version != VERSION)
        fail(path.string(), ": is a journal of version ", version, "; expected ", VERSION,
             ", which this program writes");
    return file_bytes >= FILE_HEADER_BYTES;
}

}  // namespace

std::vector<std::byte> journal_header()
{
    std::vector<std::byte> header(FILE_HEADER_BYTES);
    std::memcpy(header.data(), MAGIC, sizeof MAGIC);
    put(header.data() + sizeof MAGIC, VERSION, 4);
    return header;
}

std::vector<std::byte> framed(JournalRecord& record, std::span<const std::byte> content, uint64_t& checksum)
{
    record.label.resize(std::min<size_t>(record.label.size(), UINT16_MAX));
    record.bytes = record.stored_bytes = content.size();
    std::vector<std::byte> compressed;
    if (content.size() >= MIN_COMPRESSED_BYTES && record.kind != RecordKind::head) {
        compressed.resize(ZSTD_compressBound(content.size()));
        const size_t made = ZSTD_compress(compressed.data(), compressed.size(), content.data(), content.size(), 1);
        SHVR_CHECK(ZSTD_isError(made) == 0, ZSTD_getErrorName(made));
        record.is_compressed = made < content.size();
        if (record.is_compressed) content = std::span(compressed).first(made);
        record.stored_bytes = content.size();
    }
    const size_t label_bytes = record.label.size();
    std::vector<std::byte> frame(HEADER_BYTES + label_bytes + content.size());
    Header header{};
    put(&header[0], uint64_t(record.kind), 4);
    put(&header[4], record.is_compressed ? COMPRESSED : 0, 2);
    put(&header[6], label_bytes, 2);
    put(&header[8], record.stored_bytes, 8);
    put(&header[16], record.bytes, 8);
    put(&header[24], record.about, 8);
    if (label_bytes > 0) std::memcpy(frame.data() + HEADER_BYTES, record.label.data(), label_bytes);
    std::copy(content.begin(), content.end(), frame.begin() + ptrdiff_t(HEADER_BYTES + label_bytes));
    checksum = checksum_of(checksum, header, std::span(frame).subspan(HEADER_BYTES));
    record.checksum = checksum;
    put(&header[CHECKSUM_AT], checksum, 8);
    std::copy(header.begin(), header.end(), frame.begin());
    return frame;
}

void JournalScan::cut(size_t count)
{
    if (count >= records.size()) return;
    records.resize(count);
    end = records.empty() ? FILE_HEADER_BYTES : records.back().content_at + records.back().stored_bytes;
}

JournalScan scan_journal(const fs::path& path)
{
    JournalScan scan;
    const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!file && errno == ENOENT) return scan;
    if (!file) fail(path.string(), ": cannot be opened: ", reason_of(errno));
    struct stat status {};
    if (::fstat(file.number(), &status) != 0) fail(path.string(), ": cannot be read: ", reason_of(errno));
    if (!S_ISREG(status.st_mode)) fail(path.string(), ": is not a regular file; expected a journal, or no such file");
    scan.file_bytes = uint64_t(status.st_size);
    scan.inode = status.st_ino;
    std::vector<std::byte> body(std::min<uint64_t>(scan.file_bytes, MAX_HEAD_BYTES));
    body.resize(read_at(file, path, 0, body));
    scan.head = repaired_head(body, path);
    if (!has_file_header(file, path, scan)) return scan;
    scan.end = FILE_HEADER_BYTES;

    for (;;) {
        Header header;
        if (read_at(file, path, scan.end, header, scan.head) < HEADER_BYTES) break;
        uint64_t label_bytes = 0;
        JournalRecord record = fields_of(header, scan.end, label_bytes);
        const uint64_t left = scan.file_bytes - std::min(scan.file_bytes, scan.end + HEADER_BYTES);
        if (record.stored_bytes > left || label_bytes > left - record.stored_bytes) break;
        if (!has_plausible_sizes(record)) break;
        body.resize(label_bytes + record.stored_bytes);
        if (read_at(file, path, scan.end + HEADER_BYTES, body, scan.head) < body.size()) break;
        record.checksum = checksum_of(scan.checksum(), header, body);
        if (record.checksum != get(&header[CHECKSUM_AT], 8)) break;
        const auto kind = uint32_t(record.kind);
        if (kind > uint32_t(LAST_KIND) && kind < FIRST_ADDITION)
            fail(path.string(), ": record ", scan.records.size() + 1, " is of kind ", kind,
                 ", which this program does not know; expected 1 to ", uint32_t(LAST_KIND),
                 ": a newer program wrote it");
        record.label.assign(reinterpret_cast<const char*>(body.data()), label_bytes);
        scan.records.push_back(std::move(record));
        scan.end += HEADER_BYTES + body.size();
    }
    return scan;
}

std::optional<ParsedRecord> parse_record(std::span<const std::byte> bytes, uint64_t checksum_before)
{
    Header header;
    if (bytes.size() < header.size()) return std::nullopt;
    std::ranges::copy(bytes.first(header.size()), header.begin());
    uint64_t label_bytes = 0;
    JournalRecord record = fields_of(header, 0, label_bytes);
    const std::span<const std::byte> rest = bytes.subspan(header.size());
    if (record.stored_bytes > rest.size() || label_bytes > rest.size() - record.stored_bytes) return std::nullopt;
    if (!has_plausible_sizes(record)) return std::nullopt;
    const size_t body_bytes = size_t(label_bytes + record.stored_bytes);
    record.checksum = checksum_of(checksum_before, header, rest.first(body_bytes));
    if (record.checksum != get(&header[CHECKSUM_AT], 8)) return std::nullopt;
    return ParsedRecord{std::move(record), header.size() + body_bytes};
}

std::vector<std::byte> content_of(const JournalRecord& record, const FileDescriptor& file, const fs::path& path,
                                  std::span<const std::byte> head)
{
    std::vector<std::byte> stored(record.stored_bytes);
    if (read_at(file, path, record.content_at, stored, head) < stored.size())
        fail(path.string(), ": ends before byte ", record.content_at + record.stored_bytes,
             "; expected what was written there");
    if (!record.is_compressed) return stored;
    if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != record.bytes)
        fail(path.string(), ": the record at byte ", record.content_at, " is damaged; expected ", record.bytes,
             " bytes in it");
    std::vector<std::byte> content(record.bytes);
    const size_t made = ZSTD_decompress(content.data(), content.size(), stored.data(), stored.size());
    if (made != content.size())
        fail(path.string(), ": the record at byte ", record.content_at, " is damaged; expected a zstd frame of ",
             record.bytes, " bytes");
    return content;
}

uint64_t digest_of(std::span<const std::byte> bytes)
{
    Checksum checksum(0);
    checksum.add(bytes);
    return checksum.value();
}

std::optional<uint64_t> file_digest(const fs::path& path)
{
    std::error_code ignored;
    if (path.empty() || !fs::exists(path, ignored)) return std::nullopt;
    Checksum checksum(0);
    std::vector<std::byte> buffer(size_t{1} << 18);
    const auto add_file = [&](const fs::path& file_path) {
        const FileDescriptor file(::open(file_path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
        if (!file) fail(file_path.string(), ": cannot be opened: ", reason_of(errno));
        for (uint64_t at = 0;;) {
            const size_t count = read_at(file, file_path, at, buffer);
            if (count == 0) return;
            checksum.add(std::span(buffer).first(count));
            at += count;
        }
    };
    if (!fs::is_directory(path, ignored)) {
        add_file(path);
        return checksum.value();
    }
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path))
        if (entry.is_regular_file() && !is_desktop_file(entry.path())) files.push_back(entry.path());
    std::ranges::sort(files);
    for (const fs::path& file : files) {
        const std::string name = file.lexically_relative(path).string();
        checksum.add(std::as_bytes(std::span(name)));
        add_file(file);
    }
    return checksum.value();
}

}  // namespace shvr
