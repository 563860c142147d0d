#include "service/server/store/job_upgrade.hpp"

#include <algorithm>
#include <span>

#include "base/memory.hpp"
#include "service/protocol/job_hash.hpp"
#include "service/protocol/job_spec.hpp"
#include "service/server/store/file.hpp"

namespace octopair::service {

namespace {

/// Writes the new file. Returns the contents besides the input.
StoredSpec rewrite(const File& from, const File& to, const StoredSpec& old) {
    StoredSpec fresh = old;
    fresh.algorithm = algorithm_version;
    const std::string block = encode_block(fresh);
    fresh.input_at = block.size();
    const std::uint64_t bytes = input_bytes(old.spec);
    to.reserve(job_file_bytes(block, bytes));
    to.write(0, std::as_bytes(std::span(block)));
    JobHash old_hash(old.spec, old.algorithm), fresh_hash(old.spec);
    Buffer<std::byte> piece(piece_bytes);
    for (std::uint64_t done = 0; done < bytes;) {
        const auto part = piece.span().first(std::size_t(std::min<std::uint64_t>(bytes - done, piece.size())));
        from.read(old.input_at + done, part);
        old_hash.add(part);
        fresh_hash.add(part);
        to.write(fresh.input_at + done, part);
        done += part.size();
    }
    if (old_hash.digest() != old.hash)
        fail_damaged(from.name(), "the hash of the input does not match the submitted job");
    fresh.hash = fresh_hash.digest();
    const std::string end = encode_job_end(block, fresh.hash);
    to.write(fresh.input_at + bytes, std::as_bytes(std::span(end)));
    return fresh;
}

}  // namespace

StoredSpec upgrade_job(const std::string& base, const StoredSpec& old) {
    const std::string path = base + ".job";
    const File from(path, File::Mode::read);
    const File to(path + ".part", File::Mode::create);
    try {
        StoredSpec fresh = rewrite(from, to, old);
        to.finish(path);
        return fresh;
    } catch (...) {
        remove_file(to.path());
        throw;
    }
}

}  // namespace octopair::service
