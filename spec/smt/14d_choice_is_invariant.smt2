; THEOREM    14d: neither the unit of the losses nor what a state costs anyway changes a decision.
; ASSUMED    A belief in two states, p1 and p2; the losses of two actions; the same losses in a unit k
;            times as small, with c1 and c2 added to both actions in the two states.
; CONCLUDED  One action is the better one by both.
; SOURCE     S2 E22; spec/decide.md decide.INV-10.
; TWIN       the loss is added to one action only.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const p1 Real)       ; probabilities
(declare-const p2 Real)
(declare-const a1 Real)       ; losses of one action
(declare-const a2 Real)
(declare-const b1 Real)       ; losses of the other
(declare-const b2 Real)
(declare-const k Real)        ; unit
(declare-const c1 Real)       ; what the states cost anyway
(declare-const c2 Real)
(declare-const d1 Real)       ; the same, for the other action
; Formulas
(define-fun before () Real (- (+ (* a1 p1) (* a2 p2)) (+ (* b1 p1) (* b2 p2))))
(define-fun after () Real
  (- (+ (* (+ (* k a1) c1) p1) (* (+ (* k a2) c2) p2))
     (+ (* (+ (* k b1) d1) p1) (* (+ (* k b2) c2) p2))))

; Assumptions
(assert (>= p1 0))
(assert (>= p2 0))
(assert (= (+ p1 p2) 1))
(assert (> k 0))
(assert (= d1 c1))

; Conclusion, negated
(assert (not (= (>= before 0) (>= after 0))))
(check-sat)
