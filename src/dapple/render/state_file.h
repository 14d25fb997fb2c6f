// The container of checkpoints: a kind, a list of named texts, a body of bytes, and a checksum of all of it. The file
// is whole or not there; what was cut or damaged is refused.
//
//   "\x89DAPPLE\n"   kind (8 characters)   format
//   key '\0' text '\0' key '\0' text '\0' ...
//   body
//   bytes of keys and texts   bytes of the body   hash of all before (2 words)
//
// Numbers are words of 64 bits, little endian.
#pragma once

#include <functional>
#include <istream>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace dapple {

// In order; keys may repeat. Texts hold no zero character.
using StateFields = std::vector<std::pair<std::string, std::string>>;

inline constexpr uint64_t state_format = 1;

// Writes beside the place, syncs, renames and syncs the folder. Throws UserError, naming file and cause; an older file
// is then still as it was.
void write_state_file(const std::string& path, const std::string& kind, const StateFields& fields,
                      const std::function<void(std::ostream&)>& write_body);

// Reads the whole file once to check it, then fields and body. Throws UserError when it is missing, of another kind or
// format, cut or damaged.
StateFields read_state_fields(const std::string& path, const std::string& kind);
void read_state_body(const std::string& path, const std::string& kind,
                     const std::function<void(std::istream&)>& read_body);

}  // namespace dapple
