import {writeFileSync} from 'node:fs';
writeFileSync(process.argv[2], '<!doctype html><title>octopair</title><!-- data --><script></script>\n');
