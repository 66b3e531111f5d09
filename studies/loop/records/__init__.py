"""The records of a campaign as the loop works on them: rotations rebuilt, windows cut, tests held out, errors."""
