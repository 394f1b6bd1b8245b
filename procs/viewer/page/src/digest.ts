/** Digest of a surface: the sum of its blocks' hashes in 64 bits, which does not depend on their order. */
export class Digest {
  private sum = 0n;

  add(hash: bigint): void {
    this.sum = BigInt.asUintN(64, this.sum + hash);
  }

  remove(hash: bigint): void {
    this.sum = BigInt.asUintN(64, this.sum - hash);
  }

  clear(): void {
    this.sum = 0n;
  }

  /** 16 hex digits. */
  text(): string {
    return this.sum.toString(16).padStart(16, "0");
  }
}

/** Whether two digests in hex are the same number, however many zeros stand before them. */
export function sameDigest(a: string, b: string): boolean {
  const short = (text: string): string => text.toLowerCase().replace(/^(0x)?0*/, "");
  return short(a) === short(b);
}
