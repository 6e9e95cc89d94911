export function Review() {
  return <main class="review"><p class="boot">Review</p></main>;
}
