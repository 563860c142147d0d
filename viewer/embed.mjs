// Writes the page as C++: node embed.mjs PAGE.html PAGE.cpp
import {readFileSync, writeFileSync} from 'node:fs';
import {gzipSync} from 'node:zlib';

const [page, source] = process.argv.slice(2);
const html = readFileSync(page), bytes = gzipSync(html, {level: 9});
bytes[9] = 255;  // the header's operating system: unknown, so that the bytes are the same everywhere
const lines = [];
for (let at = 0; at < bytes.length; at += 40) lines.push([...bytes.subarray(at, at + 40)].join(','));
writeFileSync(source, `// Made by viewer/embed.mjs.
#include "viewer/server/page.hpp"

namespace octopair::viewer {

const std::size_t page_size = ${html.length};
const std::size_t compressed_page_size = ${bytes.length};
const unsigned char compressed_page_bytes[] = {
${lines.join(',\n')}};

}  // namespace octopair::viewer
`);
